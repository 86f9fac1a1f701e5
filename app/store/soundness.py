"""Whether a run's files are what was written; asked before anybody uses what they say."""

import json
import os
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store.lock import is_being_written
from catseye.app.store.schema import LAST_OPENED_OR_ENDED, UNREADABLE, open_reader
from catseye.app.store.seal import (
    DATABASE,
    MANIFEST,
    PROMISED,
    Manifest,
    digest,
    is_marked_unsealed,
    read_manifest,
)
from catseye.drivers.roles.text import harmless

_Stamp = tuple[tuple[str, int, int, int, int], ...]

_known: dict[Path, tuple[_Stamp, tuple[str, ...]]] = {}
"""What was found for the files as they were then; a run of tens of MB is hashed once in a process."""

_MOST_KNOWN = 1000


def differences(directory: Path, manifest: Manifest) -> tuple[str, ...]:
    """Return how a run's files differ from what was sealed; empty when they do not."""
    found = digest(directory)
    problems = [f"{harmless(name)} is missing" for name in manifest.files if name not in found]
    problems += [f"{harmless(name)} was added after the end" for name in found if name not in manifest.files]
    changed = [name for name, file in manifest.files.items() if name in found and found[name] != file]
    return (*problems, *(f"{harmless(name)} was changed after the end" for name in changed))


def against_manifest(directory: Path) -> tuple[Manifest | None, tuple[str, ...]]:
    """Return a run's manifest, None without a readable one, and what speaks against the run as it was sealed."""
    try:
        manifest = read_manifest(directory)
        found = lost_manifest(directory) if manifest is None else differences(directory, manifest)
        # Somebody goes on with the run just now, or has just sealed it.
        if found and read_manifest(directory) != manifest:
            return against_manifest(directory)
    except StorageError as error:
        return None, (str(error),)
    except OSError as error:
        return None, (f"{directory.name} cannot be read: {error}",)
    return manifest, found


def changes(directory: Path) -> tuple[str, ...]:
    """Return what speaks against a run that was sealed; empty for a sound one, and for one that never was."""
    return _remembered(directory, _changes)


def lost_manifest(directory: Path) -> tuple[str, ...]:
    """Return that a run without a manifest had one; empty when it never had, or nobody can say any more."""
    if is_marked_unsealed(directory):
        return ()
    with closing(open_reader(directory / DATABASE)) as connection:
        try:
            last = connection.execute(LAST_OPENED_OR_ENDED).fetchone()
            promised = last is not None and json.loads(last["data"]).get(PROMISED) is True
        except (*UNREADABLE, ValueError, AttributeError):
            # A damaged database is found as such.
            return ()
    return (f"{MANIFEST} is missing",) if promised else ()


def damage(directory: Path) -> tuple[str, ...]:
    """Return what SQLite finds wrong with the database of a run that is not sealed and that nobody writes."""
    if is_being_written(directory) or read_manifest(directory) is not None:
        return ()
    return _remembered(directory / DATABASE, integrity)


def integrity(database: Path) -> tuple[str, ...]:
    """Return what SQLite finds wrong with a file; empty when it is sound.

    Raises:
        StorageError: it cannot be opened.
    """
    with closing(open_reader(database)) as connection:
        try:
            found = tuple(str(row[0]) for row in connection.execute("PRAGMA integrity_check"))
            whole_bytes = _value(connection, "page_count") * _value(connection, "page_size")
        except UNREADABLE as error:
            return (str(error),)
    return _cut_short(database, whole_bytes) if found == ("ok",) else found


def _value(connection: sqlite3.Connection, pragma: str) -> int:
    return int(connection.execute(f"PRAGMA {pragma}").fetchone()[0])


def _cut_short(database: Path, whole_bytes: int) -> tuple[str, ...]:
    """Return that the last page is not whole: SQLite takes zeros for what is missing of it."""
    log = Path(f"{database}-wal")
    if log.exists() and log.stat().st_size:
        # The newest pages are in the log; the file itself may be shorter.
        return ()
    there_bytes = database.stat().st_size
    return () if there_bytes >= whole_bytes else (f"it ends after {there_bytes} of {whole_bytes} bytes",)


def _changes(directory: Path) -> tuple[str, ...]:
    return against_manifest(directory)[1]


def _remembered(path: Path, look: Callable[[Path], tuple[str, ...]]) -> tuple[str, ...]:
    stamp = _stamp(path if path.is_dir() else path.parent)
    known = _known.get(path)
    if known is not None and known[0] == stamp:
        return known[1]
    if len(_known) >= _MOST_KNOWN:
        _known.clear()
    found = look(path)
    _known[path] = stamp, found
    return found


def _stamp(directory: Path) -> _Stamp:
    """Return what changes when a file does; the time of change cannot be set back.

    Raises:
        StorageError: the directory cannot be listed.
    """
    try:
        with os.scandir(directory) as entries:
            facts = [(entry.name, entry.stat(follow_symlinks=False)) for entry in entries]
    except OSError as error:
        raise StorageError(f"{directory} cannot be listed: {error}") from error
    # What a reader of SQLite leaves beside the file says nothing.
    facts = [
        (n, f) for n, f in facts if not n.endswith("-shm") and not (n.endswith("-wal") and f.st_size == 0)
    ]
    return tuple(sorted((n, f.st_size, f.st_mtime_ns, f.st_ctime_ns, f.st_ino) for n, f in facts))
