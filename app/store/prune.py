"""Old runs that nobody needs any more, and those that somebody keeps."""

import fcntl
import os
import shutil
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError

from catseye.app.errors import StorageError
from catseye.app.files.atomic import write_atomically
from catseye.app.store.lock import RunLock, is_being_written
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.resumable import why_not_resumable
from catseye.app.store.run_names import run_folders, start_of
from catseye.app.store.seal import read_manifest

KEPT: Final = ".kept.json"
"""Names the runs of a folder that are never removed."""

_LOCK: Final = ".kept.lock"
"""Held while that list is changed, or a run goes by it."""

_GOING: Final = ".removed-"
"""Begins the name of a run that is being removed: it is none any more, and the next time goes on with it."""


class Kept(BaseModel):
    """Runs that are never removed, with the reason of each."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    runs: dict[str, str] = {}


@dataclass(frozen=True)
class Old:
    """A run that is older than the limit.

    Attributes:
        path: its directory.
        bytes: that it takes.
        why_not: why it stays; empty where it goes.
    """

    path: Path
    bytes: int
    why_not: str


def kept_runs(root: Path) -> Kept:
    """Return the runs that are kept.

    Raises:
        StorageError: the list cannot be read: then nothing may be removed.
    """
    path = root / KEPT
    if not path.exists():
        return Kept()
    try:
        return Kept.model_validate_json(path.read_bytes())
    except (OSError, ValidationError) as error:
        raise StorageError(
            f"{path}: cannot be read ({error}): restore it, or remove it and keep the runs again"
        ) from error


def keep(root: Path, runs: Iterable[str], reason: str) -> None:
    """Keep runs for ever.

    Args:
        runs: their names.
        reason: as for which result they are the baseline.

    Raises:
        StorageError: the list cannot be read or written.
    """
    with _alone(root):
        found = {**kept_runs(root).runs, **dict.fromkeys(runs, reason)}
        write_atomically(root / KEPT, Kept(runs=found).model_dump_json(indent=1) + "\n")


def release(root: Path, runs: Iterable[str]) -> None:
    """Keep runs no longer.

    Raises:
        StorageError: the list cannot be read or written.
    """
    gone = set(runs)
    with _alone(root):
        left = {name: reason for name, reason in kept_runs(root).runs.items() if name not in gone}
        write_atomically(root / KEPT, Kept(runs=left).model_dump_json(indent=1) + "\n")


def old_runs(root: Path, age: timedelta, now: datetime, *, unfinished: bool = False) -> list[Old]:
    """Return the runs that began longer ago than an age, oldest first; each says why it stays.

    Args:
        now: UTC time.
        unfinished: runs that could go on do not stay for that.

    Raises:
        StorageError: the folder or the list of kept runs cannot be read.
    """
    kept = kept_runs(root).runs
    paths = (path for path, match in run_folders(root) if now - start_of(match) > age)
    return [old for path in paths if (old := _old(path, kept, unfinished=unfinished)) is not None]


def remove(run: Path, *, unfinished: bool = False) -> str:
    """Remove a run if it still may go; what interrupts that leaves no half run behind.

    Returns:
        Why it stays; empty where it is gone.

    Raises:
        StorageError: it cannot be removed, or the list of kept runs cannot be read.
    """
    going = run.with_name(f"{_GOING}{run.name}")
    try:
        with _alone(run.parent):
            if not run.exists():
                return "somebody else has removed it"
            if why_not := _why_not(run, kept_runs(run.parent).runs, unfinished=unfinished):
                return why_not
            lock = RunLock(run)
            run.rename(going)
        try:
            _remove_tree(going)
        finally:
            lock.release()
    except OSError as error:
        raise StorageError(f"{run}: cannot be removed: {error.strerror}; check owner and rights") from error
    return ""


def finish_removing(root: Path) -> None:
    """Remove what an interruption has left of removed runs.

    Raises:
        StorageError: it cannot be removed.
    """
    try:
        for path in root.glob(f"{_GOING}*"):
            _remove_tree(path)
    except OSError as error:
        raise StorageError(f"{root}: cannot be tidied: {error.strerror}; check owner and rights") from error


@contextmanager
def _alone(root: Path) -> Iterator[None]:
    """Let nobody else change what is kept meanwhile; the kernel gives the right back when this process dies."""
    path = root / _LOCK
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise StorageError(f"{path}: cannot be made: {error.strerror}; check folder and rights") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _remove_tree(path: Path) -> None:
    """Remove a folder; another one who tidies may be faster."""
    shutil.rmtree(path, ignore_errors=True)
    if path.exists():
        shutil.rmtree(path)


def _old(path: Path, kept: dict[str, str], *, unfinished: bool) -> Old | None:
    """Return an old run; None where somebody else removes it meanwhile."""
    try:
        old = Old(path, _bytes(path), _why_not(path, kept, unfinished=unfinished))
    except (OSError, StorageError, sqlite3.Error):
        if path.exists():
            raise
        return None
    return old if path.exists() else None


def _why_not(path: Path, kept: dict[str, str], *, unfinished: bool) -> str:
    if path.name in kept:
        return f"kept: {kept[path.name]}"
    if is_being_written(path):
        return "it is under way"
    try:
        if read_manifest(path) is None:
            return "it is not sealed: catseye resume, or catseye verify"
        reader = RunReader(path, Accept.UNCHECKED)
        goes_on = reader.status != "complete" and not why_not_resumable(reader)
        return (
            "it can go on: catseye resume, or prune with --unfinished" if goes_on and not unfinished else ""
        )
    except StorageError as error:
        return str(error)


def _bytes(path: Path) -> int:
    return sum(file.lstat().st_size for file in path.iterdir())
