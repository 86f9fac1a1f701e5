"""A process that dies while SQLite leaves its log, or takes it up, leaves a run that is read and gone on with."""

import struct
from contextlib import closing
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.store.mend import seal_late
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore, leave_one_file
from catseye.app.store.schema import open_writer
from catseye.app.store.seal import DATABASE, read_manifest
from catseye.app.store.verify import verify
from tests.unit.app.store.fakes import RECORDS, TickingClock

JOURNAL = f"{DATABASE}-journal"


PAGE_BYTES = 4096


def journal_of(database: bytes, pages: int) -> bytes:
    """Return SQLite's journal of a change of its first pages that has reached the disk: it has to be undone."""
    nonce, count = 7, len(database) // PAGE_BYTES
    head = bytes.fromhex("d9d505f920a163d7") + struct.pack(">IIIII", pages, nonce, count, 512, PAGE_BYTES)
    journal = head.ljust(512, b"\0")
    for number in range(pages):
        page = database[number * PAGE_BYTES : (number + 1) * PAGE_BYTES]
        journal += struct.pack(">I", number + 1) + page + struct.pack(">I", nonce + sum(page[196::200]))
    return journal


async def cut_short(folder: Path, *, ended: bool, pages: int = 1) -> Path:
    """Return a run as it is in the middle of a change in SQLite's older mode: with a journal beside the file."""
    store = await RunStore.create(folder, "demo", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.append_step("s1", 1, "title", {"number": 1}, [])
    if ended:
        await store.event("run-ended", {"status": "complete", "exit_code": 0})
    await store.abandon()
    database = store.path / DATABASE
    with closing(open_writer(database)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    before = database.read_bytes()
    with closing(open_writer(database)) as connection:
        leave_one_file(connection)
    (store.path / JOURNAL).write_bytes(journal_of(before, pages))
    return store.path


async def test_a_run_whose_closing_was_cut_short_is_read(tmp_path: Path) -> None:
    run = await cut_short(tmp_path, ended=False)
    reader = RunReader(run)
    assert (reader.status, [step.step_id for step in reader.steps()]) == ("died", ["s1"])
    assert verify(run).problems == ()
    assert (run / JOURNAL).exists()


async def test_a_run_whose_closing_was_cut_short_goes_on(tmp_path: Path) -> None:
    run = await cut_short(tmp_path, ended=False)
    store = await RunStore.reopen(run, TickingClock(), records=RECORDS, reserve_bytes=0)
    assert store.stored_result("s1") == {"number": 1}
    await store.finish("complete", 0)
    assert verify(run).ok
    assert not (run / JOURNAL).exists()


async def test_a_complete_run_whose_closing_was_cut_short_is_sealed(tmp_path: Path) -> None:
    run = await cut_short(tmp_path, ended=True)
    assert seal_late(run, "2026-01-02T03:04:05+00:00")
    assert read_manifest(run) is not None
    assert verify(run).ok


async def test_a_journal_of_more_than_the_head_is_refused(tmp_path: Path) -> None:
    # This program changes no more in that mode: whatever did may have left half of it.
    run = await cut_short(tmp_path, ended=False, pages=2)
    with pytest.raises(StorageError, match="cannot be read"):
        RunReader(run)
