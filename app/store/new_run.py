"""What a new run begins with: a directory on a disk that has room, and what made the run."""

import os
import platform
import secrets
import shutil
import socket
import sqlite3
from datetime import datetime, timedelta
from importlib.metadata import version
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store.run_names import STARTED, run_folders, start_of
from catseye.app.store.seal import mark_unsealed
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Json


def make_directory(root: Path, procedure: str, clock: Clock, reserve_bytes: int) -> Path:
    """Create the directory of a new run, named by time, procedure and a random id.

    Names tell which run is the newer one: where the clock was set back, the name has the second after that of the
    newest run. What the clock said is in the run.

    Raises:
        StorageError: there is no space or no permission.
    """
    try:
        root.mkdir(parents=True, exist_ok=True)
        path = root / f"{_stamp(root, clock):{STARTED}}_{procedure}_{secrets.token_hex(3)}"
        require_space(root, reserve_bytes)
        path.mkdir()
        mark_unsealed(path)
    except OSError as error:
        raise StorageError(f"cannot create a run in {root}: {error}; choose another directory") from error
    return path


def _stamp(root: Path, clock: Clock) -> datetime:
    now, runs = clock.now_utc(), run_folders(root)
    if not runs:
        return now
    return max(now, start_of(runs[-1][1]) + timedelta(seconds=1.0))


def require_space(directory: Path, reserve_bytes: int) -> None:
    """Check that the disk has a reserve.

    Raises:
        StorageError: it has not.
    """
    free = shutil.disk_usage(directory).free
    if free < reserve_bytes:
        raise StorageError(
            f"{directory} has {free / 1e6:.0f} MB free, {reserve_bytes / 1e6:.0f} MB are needed; "
            "make room or choose another directory"
        )


def software() -> dict[str, Json]:
    """Return the versions that a result may depend on."""
    return {
        "catseye": version("catseye"),
        "python": platform.python_version(),
        "sqlite": sqlite3.sqlite_version,
        "numpy": version("numpy"),
        "platform": platform.platform(),
        "host": socket.gethostname(),
        "pid": os.getpid(),
    }


def clock_anchor(clock: Clock) -> dict[str, Json]:
    """Return wall and monotonic time of one instant, to relate the two."""
    return {"utc": clock.now_utc().isoformat(), "monotonic_s": clock.monotonic_s()}
