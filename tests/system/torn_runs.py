"""A run whose process died, and copies of it with a torn or altered file: what is read from them is never wrong."""

import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from catseye.app.errors import StorageError
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import DATABASE
from catseye.app.store.verify import verify

LOG: Final = f"{DATABASE}-wal"
HEADER_BYTES: Final = 32
FRAME_HEADER_BYTES: Final = 24


@dataclass(frozen=True)
class Told:
    """What a run's record says, in its order.

    Attributes:
        steps: done, each with its result.
        rows: of all tables.
        events: what happened.
    """

    steps: list[Any]
    rows: list[Any]
    events: list[Any]

    @classmethod
    def by(cls, run: Path) -> "Told":
        """Read a run.

        Raises:
            StorageError: it is damaged.
        """
        reader = RunReader(run)
        rows = [row for table in reader.tables() for row in reader.rows(table.name)]
        return cls(reader.steps(), rows, reader.events())

    def is_beginning_of(self, other: "Told") -> bool:
        """Return whether all that it has stands in the other one, too, from the first on, as it is here."""
        pairs = ((self.steps, other.steps), (self.rows, other.rows), (self.events, other.events))
        return all(whole[: len(part)] == part for part, whole in pairs)


def copied(run: Path, folder: Path) -> Path:
    """Copy database and log of a run as plain files, as an ordinary backup does."""
    copy = folder / run.name
    shutil.rmtree(copy, ignore_errors=True)
    copy.mkdir(parents=True)
    for path in run.iterdir():
        # The index of the log is made anew from the log.
        if not path.name.endswith("-shm"):
            shutil.copy(path, copy / path.name)
    return copy


def last_frame(run: Path) -> range:
    """Return the bytes of the log's last frame, as lengths that cut it off after 0 bytes and more."""
    log = (run / LOG).read_bytes()
    page_bytes = int.from_bytes(log[8:12], "big")
    frame_bytes = FRAME_HEADER_BYTES + page_bytes
    begin = HEADER_BYTES + (len(log) - HEADER_BYTES) // frame_bytes * frame_bytes - frame_bytes
    return range(begin, begin + frame_bytes)


def told_or_refused(run: Path, whole: Told) -> Told | None:
    """Read a damaged copy; what it says is a beginning of the whole, or it is refused by its name.

    Returns:
        What it says, None when it is refused.
    """
    refusal = ""
    try:
        told = Told.by(run)
    except StorageError as error:
        refusal = str(error)
    if refusal:
        assert run.name in refusal, refusal
        return None
    assert told.is_beginning_of(whole), "a damaged run says something that was never stored"
    return told


def torn(copy: Path, length: int) -> Path:
    """Cut the log of a copy off."""
    (copy / f"{DATABASE}-shm").unlink(missing_ok=True)
    os.truncate(copy / LOG, length)
    return copy


def require_sound(run: Path) -> None:
    """Check that a copy is no less than a run that died a little earlier."""
    assert verify(run).problems == ()
