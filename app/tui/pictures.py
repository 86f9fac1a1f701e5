"""Pictures of a run, drawn by a process of its own: however long it computes, keys are served."""

import asyncio
import json
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol

from catseye.drivers.roles.clock import Clock, SystemClock

if TYPE_CHECKING:
    # The first screen is painted before figures are imported.
    from catseye.app.tui.widgets.inks import Line

PROGRAM: Final = (sys.executable, "-P", "-m", "catseye.app.tui.painting")

NOTHING: Final = "nothing measured yet"

_LONGEST_LINE: Final = 64 * 1024 * 1024
LONGEST_S: Final = 60.0
"""For a picture to be drawn; the record of a long run is read first."""

_AGAIN: Final = "it is started again by itself. The measurement does not depend on it."
_GONE: Final = f"the pictures are missing: the drawing process has ended; {_AGAIN}"
_HANGS: Final = (
    f"the pictures are missing: the drawing process did not answer for {LONGEST_S:.0f} s and was ended; "
    f"{_AGAIN}"
)
_NO_START: Final = "the pictures are missing: the drawing process did not start ({error}); {again}"


@dataclass(frozen=True)
class Wanted:
    """What is to be drawn.

    Attributes:
        path: folder of the run.
        look: look what the run holds by now; otherwise what it held at the last look is drawn.
        first: place of the figure that comes first; beyond the last one it begins anew.
        width: in cells.
        height: in cells.
    """

    path: Path
    look: bool
    first: int
    width: int
    height: int


@dataclass(frozen=True)
class Pictures:
    """What was drawn.

    Attributes:
        titles: of all figures that the run has, in their own order.
        first: place of the one that is drawn first.
        shown: how many are drawn.
        lines: pieces of text with their ink.
        note: why there is nothing; empty where there is.
        failed: they could not be drawn, whatever the run holds.
    """

    titles: tuple[str, ...] = ()
    first: int = 0
    shown: int = 0
    lines: "tuple[Line, ...]" = ()
    note: str = ""
    failed: bool = False


class Painter(Protocol):
    """Draws runs."""

    async def draw(self, wanted: Wanted) -> Pictures:
        """Return the pictures of a run."""
        ...

    async def close(self) -> None:
        """Leave nothing behind."""
        ...


class PaintingProcess:
    """Implements `Painter` with a process that lives as long as this one.

    A process that dies, hangs or does not start costs a picture, never more: the next drawing begins with a new one.

    Args:
        program: answers a line for each line that it is given.
        clock: of the time that a picture may take.
    """

    def __init__(self, program: Sequence[str] = PROGRAM, clock: Clock | None = None) -> None:
        self._program = program
        self._clock = SystemClock() if clock is None else clock
        self._process: asyncio.subprocess.Process | None = None
        self._killed: list[asyncio.subprocess.Process] = []

    async def draw(self, wanted: Wanted) -> Pictures:
        """Return the pictures of a run; one is drawn at a time."""
        try:
            process = self._process or await self._started()
        except OSError as error:
            return _missing(_NO_START.format(error=error, again=_AGAIN))
        answer = asyncio.ensure_future(_answer(process, wanted))
        limit = asyncio.ensure_future(self._clock.sleep(LONGEST_S))
        line = b""
        try:
            await asyncio.wait((answer, limit), return_when=asyncio.FIRST_COMPLETED)
            hangs = not answer.done()
            line = b"" if hangs else answer.result()
        finally:
            answer.cancel()
            limit.cancel()
            if not line:
                # What it answers later would be taken for the answer to the next question.
                self._process = None
                self._end(process)
        if not line:
            return _missing(_HANGS if hangs else _GONE)
        return pictures_of(line)

    async def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is not None:
            self._end(process)
        killed, self._killed = self._killed, []
        for one in killed:
            await one.wait()

    def _end(self, process: asyncio.subprocess.Process) -> None:
        """Kill a process; `close` waits for its end, for whoever is cancelled cannot."""
        _kill(process)
        self._killed = [one for one in (*self._killed, process) if one.returncode is None]

    async def _started(self) -> asyncio.subprocess.Process:
        # It ends with the pipe; a session of its own keeps the keys of the terminal from it.
        self._process = await asyncio.create_subprocess_exec(
            *self._program,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            start_new_session=True,
            limit=_LONGEST_LINE,
        )
        return self._process


async def _answer(process: asyncio.subprocess.Process, wanted: Wanted) -> bytes:
    """Return the line that a process answers; nothing if it has ended."""
    if process.stdin is None or process.stdout is None:
        raise RuntimeError("the process has no pipes")
    try:
        process.stdin.write(f"{json.dumps({**asdict(wanted), 'path': str(wanted.path)})}\n".encode())
        await process.stdin.drain()
        return await process.stdout.readline()
    except ConnectionError:
        return b""


def _missing(note: str) -> Pictures:
    return Pictures(note=note, failed=True)


def _kill(process: asyncio.subprocess.Process) -> None:
    # It may have ended meanwhile.
    with suppress(ProcessLookupError):
        process.kill()


def pictures_of(line: bytes) -> Pictures:
    """Return what a line of the process says."""
    said = json.loads(line)
    lines = tuple([(text, ink) for text, ink in drawn] for drawn in said["lines"])
    return Pictures(tuple(said["titles"]), said["first"], said["shown"], lines, said["note"])
