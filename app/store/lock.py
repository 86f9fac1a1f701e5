"""Who writes a run: a lock on its directory that ends with the process that holds it."""

import fcntl
import os
import time
from pathlib import Path

from catseye.app.errors import StorageError

_LOOKS = 5
_LOOK_S = 0.005
"""Real seconds between two tries."""


class RunLock:
    """Exclusive right to write a run; the kernel takes it back when the process dies.

    Args:
        directory: the run's directory.

    Raises:
        StorageError: another process writes this run, or its directory cannot be opened.
    """

    def __init__(self, directory: Path) -> None:
        self._descriptor: int | None = _opened(directory)
        try:
            self._take(self._descriptor)
        except BlockingIOError as error:
            self.release()
            raise StorageError(
                f"{directory} is being written by a running catseye; stop that first"
            ) from error

    @staticmethod
    def _take(descriptor: int) -> None:
        """Take the lock; somebody who only looks whether the run is written holds it for a moment."""
        for _ in range(_LOOKS):
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(_LOOK_S)
            else:
                return
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def release(self) -> None:
        """Give the right back; may be called any number of times."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


def is_being_written(directory: Path) -> bool:
    """Return whether a living process writes the run.

    Raises:
        StorageError: its directory cannot be opened.
    """
    descriptor = _opened(directory)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _opened(directory: Path) -> int:
    try:
        return os.open(directory, os.O_RDONLY)
    except OSError as error:
        raise StorageError(
            f"{directory} cannot be opened: {error}; ask its owner for the permission"
        ) from error
