"""What a new run begins with: a directory on a disk that has room, and what made the run."""

import os
import platform
import secrets
import shutil
import socket
import sqlite3
from importlib.metadata import version
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store.seal import mark_unsealed
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Json


def make_directory(root: Path, procedure: str, clock: Clock, reserve_bytes: int) -> Path:
    """Create the directory of a new run, named by time, procedure and a random id.

    Raises:
        StorageError: there is no space or no permission.
    """
    path = root / f"{clock.now_utc():%Y%m%dT%H%M%SZ}_{procedure}_{secrets.token_hex(3)}"
    try:
        root.mkdir(parents=True, exist_ok=True)
        require_space(root, reserve_bytes)
        path.mkdir()
        mark_unsealed(path)
    except OSError as error:
        raise StorageError(f"cannot create a run in {root}: {error}; choose another directory") from error
    return path


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
