"""Readings of a recording as a run keeps them: in chunks, each acknowledged by itself.

The bytes of a chunk are those of two columns of little-endian doubles, one after the other: times in seconds since
the recording's origin, then the readings.
"""

import sqlite3
import sys
import zlib
from array import array
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from catseye.app.errors import StorageError
from catseye.app.store.rows import row_crc32
from catseye.app.store.schema import CHUNKS, UNREADABLE, open_reader
from catseye.app.store.seal import DATABASE

Key = tuple[str, int, str]
"""Step, attempt at it, and name of the recording."""

_BYTES = 8
"""Of a double."""


@dataclass(frozen=True)
class Chunk:
    """Some readings of a recording, in their order.

    Attributes:
        times_s: since the recording's origin.
        values: one for each time.
    """

    times_s: "array[float]"
    values: "array[float]"

    def __post_init__(self) -> None:
        """Check that every reading has its time."""
        if len(self.times_s) != len(self.values):
            raise ValueError(f"{len(self.values)} readings have {len(self.times_s)} times")

    def __len__(self) -> int:
        """Return how many readings there are."""
        return len(self.times_s)


def pack(chunk: Chunk) -> bytes:
    """Return the bytes of a chunk."""
    return _little_endian(chunk.times_s).tobytes() + _little_endian(chunk.values).tobytes()


def unpack(data: bytes) -> Chunk:
    """Return the chunk that bytes hold.

    Raises:
        ValueError: they are no whole readings.
    """
    if len(data) % (2 * _BYTES):
        raise ValueError(f"{len(data)} bytes are no whole readings of {2 * _BYTES} bytes")
    columns = array("d"), array("d")
    for number, column in enumerate(columns):
        column.frombytes(data[number * len(data) // 2 : (number + 1) * len(data) // 2])
    return Chunk(*map(_little_endian, columns))


def chunks_of(run: Path, recorded: Mapping[str, Any]) -> Iterator[Chunk]:
    """Yield the chunks of a recording in their order; one at a time is in memory.

    Args:
        recorded: row of the table of `catseye.procedures.kit.recording.Recorded`.

    Raises:
        StorageError: a chunk is missing, or is not what was written; whoever takes the last one knows.
    """
    kept = Kept()
    for data, crc32, row in _rows(run, (recorded["step_id"], recorded["attempt"], recorded["name"])):
        kept.add(row["seq"], data)
        if kept.gap or row_crc32(CHUNKS, row) != crc32:
            raise _not_whole(run, recorded)
        yield unpack(data)
    if not kept.is_whole(recorded):
        raise _not_whole(run, recorded)


def _not_whole(run: Path, recorded: Mapping[str, Any]) -> StorageError:
    return StorageError(
        f"{run.name}: readings of recording {recorded['name']} are missing or are not what was written; catseye "
        "verify says more, a copy of the run may be sound"
    )


def begun_attempts(run: Path) -> dict[str, int]:
    """Return the last attempt at each step that has stored a chunk; a process that dies says nothing else of it."""
    with _connected(run) as connection:
        if not _has_chunks(connection):
            return {}
        return dict(
            connection.execute(f"SELECT step_id, max(attempt) FROM {CHUNKS} GROUP BY step_id").fetchall()
        )


def chunk_misfits(run: Path) -> list[str]:
    """Return which chunks are not what the journal says; empty for a sound record.

    Raises:
        StorageError: it cannot be read.
    """
    texts = [
        f"chunk {row['seq']} of recording {row['recording']} of step {row['step_id']} is not what was written"
        for _, crc32, row in _rows(run)
        if row_crc32(CHUNKS, row) != crc32
    ]
    with _connected(run) as connection:
        if not _has_chunks(connection):
            return texts
        missing = connection.execute(
            f"SELECT row FROM journal WHERE of = '{CHUNKS}' AND row NOT IN (SELECT rowid FROM {CHUNKS})"
        ).fetchall()
    return texts + [f"row {number} of {CHUNKS} is missing" for (number,) in missing]


@dataclass
class Kept:
    """What the chunks of one recording come to.

    Attributes:
        chunks: how many.
        readings: in them.
        crc32: of all their bytes.
        gap: a chunk is missing among them.
    """

    chunks: int = 0
    readings: int = 0
    crc32: int = 0
    gap: bool = False

    def add(self, seq: int, data: bytes) -> None:
        """Count the next chunk."""
        self.chunks += 1
        self.gap = self.gap or seq != self.chunks
        self.readings += len(data) // (2 * _BYTES)
        self.crc32 = zlib.crc32(data, self.crc32)

    def is_whole(self, recorded: Mapping[str, Any]) -> bool:
        """Return whether this is what a stored `Recorded` says."""
        stated = (recorded["chunks"], recorded["readings"], recorded["crc32"])
        return not self.gap and stated == (self.chunks, self.readings, self.crc32)


def kept_recordings(run: Path) -> dict[Key, Kept]:
    """Return what a run keeps of every recording, those that never came to their end included.

    Raises:
        StorageError: it cannot be read.
    """
    found: dict[Key, Kept] = {}
    for data, _, row in _rows(run):
        found.setdefault((row["step_id"], row["attempt"], row["recording"]), Kept()).add(row["seq"], data)
    return found


def recording_faults(
    run: Path, recorded: Sequence[Mapping[str, Any]], done: Container[tuple[str, int]]
) -> list[str]:
    """Return how the chunks of a run contradict its recordings; empty when they do not.

    Args:
        recorded: rows of the table of `catseye.procedures.kit.recording.Recorded`.
        done: steps that are done, with the attempt.
    """
    kept = kept_recordings(run)
    texts = []
    for row in recorded:
        key = (row["step_id"], row["attempt"], row["name"])
        if not kept.pop(key, Kept()).is_whole(row):
            texts.append(
                f"recording {row['name']} of step {row['step_id']} does not have all of its readings"
            )
    stray = [key for key in kept if key[:2] in done]
    return texts + [
        f"step {step_id} has readings of a recording {name} that it does not name"
        for step_id, _, name in stray
    ]


def unfinished_recordings(run: Path, done: Container[tuple[str, int]]) -> list[str]:
    """Return what a run keeps of recordings whose step never came to its end: evidence, and no data."""
    return [
        f"{kept.readings} readings of recording {name} belong to an attempt at step {step_id} that came to no end; "
        "nothing uses them"
        for (step_id, attempt, name), kept in kept_recordings(run).items()
        if (step_id, attempt) not in done
    ]


def _little_endian(column: "array[float]") -> "array[float]":
    """Return a column in the byte order of the file, or one of the file in that of this machine."""
    if sys.byteorder == "little":
        return column
    swapped = array("d", column)
    swapped.byteswap()
    return swapped


def _rows(run: Path, key: Key | None = None) -> Iterator[tuple[bytes, int, dict[str, Any]]]:
    """Yield bytes, check sum in the journal and columns of the chunks, in the order of their being stored."""
    where = "" if key is None else "WHERE c.step_id = ? AND c.attempt = ? AND c.recording = ?"
    sql = f"""
        SELECT c.step_id, c.attempt, c.recording, c.seq, c.readings, c.data, j.crc32 FROM {CHUNKS} c
        LEFT JOIN journal j ON j.of = '{CHUNKS}' AND j.row = c.rowid {where} ORDER BY c.rowid
    """
    with _connected(run) as connection:
        if _has_chunks(connection):
            for stored in connection.execute(sql, key or ()):
                row = dict(stored)
                crc32 = row.pop("crc32")
                yield row["data"], crc32, row


def _has_chunks(connection: sqlite3.Connection) -> bool:
    """Return whether there is a place for chunks; a file of an older program has none."""
    found = connection.execute("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?", (CHUNKS,))
    return found.fetchone() is not None


@contextmanager
def _connected(run: Path) -> Iterator[sqlite3.Connection]:
    database = run / DATABASE
    with closing(open_reader(database)) as connection:
        try:
            yield connection
        except UNREADABLE as error:
            raise StorageError(f"{database} cannot be read: {error}") from error
