"""Readings of recordings in a run: kept chunk by chunk, found again bit by bit, counted when their step is done."""

import asyncio
import sqlite3
import zlib
from array import array
from collections.abc import AsyncIterator
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.errors import StorageError
from catseye.app.store.chunks import Chunk, pack, unpack
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.verify import verify
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.kit.records import row_of
from tests.unit.app.store.fakes import TickingClock

KEY = ("A1", 1, "series")
READINGS = [(0.0, 1.5), (0.04, -2.0), (0.08, 1e-9), (0.13, 3.0)]


def chunk(*readings: tuple[float, float]) -> Chunk:
    times, values = zip(*readings, strict=True)
    return Chunk(array("d", times), array("d", values))


def recorded(*chunks: Chunk, name: str = "series", **changes: Any) -> Recorded:
    """Return what a step says of chunks, with the sum of their bytes taken at once."""
    values: dict[str, Any] = {
        "name": name,
        "method": "polled",
        "origin_utc": "2026-01-02T03:04:05+00:00",
        "origin_clock_s": 7.0,
        "readings": sum(map(len, chunks)),
        "chunks": len(chunks),
        "crc32": zlib.crc32(b"".join(map(pack, chunks))),
        "duration_s": 0.13,
        "rate_hz": 23.0,
        "jitter_s": 0.005,
        "longest_gap_s": 0.05,
        "late": 0,
        "lost": 0,
        "beam_lost": 0,
        "overspeed": 0,
        "values_lost": 0,
        "scale": 1.0,
        "offset_mm": 0.0,
    }
    return Recorded(**{**values, **changes})


async def opened(folder: Path) -> RunStore:
    return await RunStore.create(
        folder, "resolution", {}, TickingClock(), records=(Recorded,), reserve_bytes=0
    )


@pytest.fixture
async def store(tmp_path: Path) -> AsyncIterator[RunStore]:
    made = await opened(tmp_path)
    yield made
    await made.abandon()


async def keep(store: RunStore, *chunks: Chunk, of: Recorded | None = None) -> None:
    """Store chunks, then the step that names them."""
    for number, each in enumerate(chunks, 1):
        await store.append_chunk(KEY, number, each)
    row = row_of(of or recorded(*chunks))
    await store.append_step(KEY[0], KEY[1], "A1", {}, [(Recorded.table, row)])


@given(st.lists(st.tuples(*[st.floats(allow_nan=False)] * 2), min_size=1, max_size=50))
def test_packed_readings_come_back_bit_by_bit(readings: list[tuple[float, float]]) -> None:
    packed = pack(chunk(*readings))
    assert len(packed) == 16 * len(readings)
    assert pack(unpack(packed)) == packed
    assert list(zip(unpack(packed).times_s, unpack(packed).values, strict=True)) == readings


def test_bytes_are_two_little_endian_columns() -> None:
    one, minus_two = bytes.fromhex("000000000000f03f"), bytes.fromhex("00000000000000c0")
    assert pack(chunk((1.0, -2.0), (1.0, 1.0))) == one + one + minus_two + one


@pytest.mark.parametrize("length", [1, 8, 15, 24])
def test_bytes_that_are_no_whole_readings_are_refused(length: int) -> None:
    with pytest.raises(ValueError, match="no whole readings"):
        unpack(bytes(length))


@given(cuts=st.sets(st.integers(1, 3)))
def test_readings_are_the_same_however_they_were_cut(
    tmp_path_factory: pytest.TempPathFactory, cuts: set[int]
) -> None:
    async def stored() -> Path:
        store = await opened(tmp_path_factory.mktemp("runs"))
        await keep(store, *(chunk(*READINGS[a:b]) for a, b in pairwise([0, *sorted(cuts), 4])))
        await store.finish("complete", 0)
        return store.path

    run = asyncio.run(stored())
    assert verify(run).ok
    reader = RunReader(run)
    (row,) = reader.recordings()
    found = [pair for part in reader.chunks(row) for pair in zip(part.times_s, part.values, strict=True)]
    assert found == READINGS


async def test_an_acknowledged_chunk_is_there_for_every_reader(store: RunStore) -> None:
    await store.append_chunk(KEY, 1, chunk(*READINGS))
    with closing(sqlite3.connect(store.path / "run.sqlite")) as connection:
        assert connection.execute("SELECT readings, data FROM chunks").fetchall() == [
            (4, pack(chunk(*READINGS)))
        ]


async def test_readings_of_an_unfinished_step_count_for_nothing(store: RunStore) -> None:
    await store.append_chunk(KEY, 1, chunk(*READINGS))
    assert RunReader(store.path).recordings() == []
    found = verify(store.path)
    assert found.ok
    assert found.notes[-1] == (
        "4 readings of recording series belong to an attempt at step A1 that came to no end; nothing uses them"
    )


async def test_a_step_that_died_is_attempted_under_another_number(tmp_path: Path) -> None:
    store = await opened(tmp_path)
    await store.append_chunk(KEY, 1, chunk(*READINGS))
    # No word of a dropped step, as after `kill -9`.
    await store.abandon()
    again = await RunStore.reopen(store.path, TickingClock(), records=(Recorded,), reserve_bytes=0)
    assert again.next_attempt("A1") == 2
    await again.append_chunk(("A1", 2, "series"), 1, chunk(*READINGS))
    await again.append_step("A1", 2, "A1", {}, [(Recorded.table, row_of(recorded(chunk(*READINGS))))])
    await again.finish("complete", 0)
    assert verify(again.path).ok
    (row,) = RunReader(again.path).recordings()
    assert [len(part) for part in RunReader(again.path).chunks(row)] == [4]


@pytest.mark.parametrize(
    "tamper",
    [
        "UPDATE chunks SET data = zeroblob(32) WHERE seq = 1",
        "UPDATE chunks SET seq = 3 WHERE seq = 2",
        "DELETE FROM chunks WHERE seq = 2",
    ],
)
async def test_chunks_cannot_be_changed_by_hand(store: RunStore, tamper: str) -> None:
    await keep(store, chunk(*READINGS[:2]), chunk(*READINGS[2:]))
    with closing(sqlite3.connect(store.path / "run.sqlite")) as connection:
        with pytest.raises(sqlite3.IntegrityError, match="append-only"):
            connection.execute(tamper)
        connection.execute("DROP TRIGGER chunks_no_update")
        connection.execute("DROP TRIGGER chunks_no_delete")
        connection.execute(tamper)
        connection.commit()
    assert "recording series of step A1 does not have all of its readings" in verify(store.path).problems
    reader = RunReader(store.path)
    with pytest.raises(StorageError, match="series"):
        assert sum(map(len, reader.chunks(reader.recordings()[0]))) == len(READINGS)


async def test_a_flipped_bit_of_a_reading_is_found(store: RunStore) -> None:
    await keep(store, chunk(*READINGS))
    await store.finish("complete", 0)
    database = store.path / "run.sqlite"
    data = bytearray(database.read_bytes())
    at = bytes(data).index(pack(chunk(*READINGS)))
    data[at + 40] ^= 1
    database.chmod(0o644)
    database.write_bytes(bytes(data))
    found = verify(store.path)
    assert "chunk 1 of recording series of step A1 is not what was written" in found.problems
    assert "run.sqlite was changed after the end" in found.problems


async def test_readings_that_no_recording_names_are_a_fault(store: RunStore) -> None:
    await store.append_chunk((*KEY[:2], "other"), 1, chunk(*READINGS))
    await keep(store, chunk(*READINGS))
    assert verify(store.path).problems == ("step A1 has readings of a recording other that it does not name",)


async def test_a_recording_without_its_chunks_is_a_fault(store: RunStore) -> None:
    await keep(store, of=recorded(chunk(*READINGS)))
    assert verify(store.path).problems == ("recording series of step A1 does not have all of its readings",)
