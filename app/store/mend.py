"""Finishing what a process that died at the very end has left undone."""

import sqlite3
from contextlib import closing
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store import seal
from catseye.app.store.lock import RunLock
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import leave_one_file
from catseye.app.store.schema import open_writer


def seal_late(path: Path, now_utc: str) -> bool:
    """Seal a complete run whose process died between the closing record and the manifest.

    Args:
        path: the run's directory.
        now_utc: ISO 8601 UTC time.

    Returns:
        Whether there was anything to do.

    Raises:
        StorageError: the run cannot be read or written, or another process writes it.
    """
    if RunReader(path).status != "complete" or seal.read_manifest(path) is not None:
        return False
    lock = RunLock(path)
    try:
        seal.unseal(path)
        with closing(open_writer(path / seal.DATABASE)) as connection:
            leave_one_file(connection)
        seal.seal(path, now_utc)
    except (OSError, sqlite3.Error) as error:
        raise StorageError(
            f"cannot seal {path}: {error}; make that possible, then resume it again"
        ) from error
    finally:
        lock.release()
    return True
