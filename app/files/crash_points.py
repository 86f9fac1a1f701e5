"""Named places where a test lets the process die, as by `kill -9`.

`CATSEYE_CRASHPOINT=name` kills it at the first pass of that place, `name:n` at the n-th; without the variable a place
costs two comparisons.
"""

import os
import signal
from collections.abc import Mapping

from catseye.app.errors import UsageError

VARIABLE = "CATSEYE_CRASHPOINT"

RUN_POINTS: Mapping[str, str] = {
    "directory-made": "a new run has a directory and nothing in it",
    "run-opened": "a new run has described itself",
    "unsealed": "a run that goes on has lost its manifest and says nothing about it yet",
    "reopened": "a run that goes on has said so",
    "devices-connected": "all devices have answered",
    "before-motion": "a motion has passed the gate and is about to begin",
    "after-motion": "a motion has ended",
    "zeroed": "the count has been zeroed",
    "prompt-open": "a question has been put and not answered",
    "chunk-stored": "a chunk of a recording is stored, its step goes on",
    "before-commit": "a step has done its work and is not stored",
    "after-commit": "a step is stored and not yet published",
    "before-closing": "the run is over and has no closing record",
    "closed": "the closing record is stored, the files are open",
    "before-manifest": "the files are read-only, the manifest has not got its name",
    "sealed": "the manifest is there, the process goes on",
}
"""Places on the way of a run and what has happened there."""

FILE_POINTS: Mapping[str, str] = {
    "file-begun": "a file beside the runs has a draft with nothing in it",
    "file-drafted": "the draft is whole and on the disk, and has not got the file's name",
    "file-named": "the file is there, the process goes on",
}
"""Places on the way of a file that is written whole: a result, a report, an export."""

POINTS: Mapping[str, str] = {**RUN_POINTS, **FILE_POINTS}


class _Trap:
    """Where the process is to die, and how often it has been there."""

    def __init__(self) -> None:
        self.name = ""
        self.passes_left = 0
        self.is_armed = False


_trap = _Trap()


def arm(environment: Mapping[str, str]) -> None:
    """Take the place from the environment.

    Raises:
        UsageError: there is no such place; the text lists those that there are.
    """
    name, _, count = environment.get(VARIABLE, "").partition(":")
    if name and (name not in POINTS or not (count or "1").isdecimal() or int(count or "1") < 1):
        raise UsageError(
            f"{VARIABLE} = {environment[VARIABLE]!r} has to be name or name:n, with n from 1; the names are: "
            f"{', '.join(POINTS)}"
        )
    _trap.name, _trap.passes_left, _trap.is_armed = name, int(count or "1"), True


def crash_point(name: str) -> None:
    """Die here if the environment says so.

    Args:
        name: one of POINTS.
    """
    if not _trap.is_armed:
        # A command that only writes files has no start at which it would look.
        arm(os.environ)
    if _trap.name == name:
        _trap.passes_left -= 1
        if _trap.passes_left == 0:
            os.kill(os.getpid(), signal.SIGKILL)
