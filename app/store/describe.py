"""What a run says about the program and the machine that made it."""

import os
import platform
import socket
import sqlite3
from importlib.metadata import version

from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Json


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
