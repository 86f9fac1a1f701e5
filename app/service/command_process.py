"""The commands of `catseye`, each in a process of its own."""

import asyncio
import json
import os
import shlex
import signal
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from catseye.app.protocol.channel import EVENTS_FD

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from pydantic import BaseModel

    from catseye.app.protocol.commands import CommandEvent

Written = TypeVar("Written", bound="BaseModel")

Signal = Callable[[int], None]
"""Sends a process a signal."""

_LONGEST_LINE = 64 * 1024 * 1024
_END_S = 5.0
_NICENESS = 5


@dataclass(frozen=True)
class Done:
    """How a command ended.

    Attributes:
        arguments: of the command, without its name.
        code: exit code, as docs and `catseye` have them.
        out: data that it wrote.
        talk: what it said to people.
        events: what it reported, in order.
    """

    arguments: tuple[str, ...]
    code: int
    out: str
    talk: str
    events: "tuple[CommandEvent, ...]" = ()

    @property
    def line(self) -> str:
        """The command as somebody would type it."""
        return command_line(self.arguments)

    @property
    def fault(self) -> str:
        """Why it failed; empty when all is well."""
        from catseye.app.protocol.commands import CommandFailed

        if self.code == 0:
            return ""
        reported = [event.text for event in self.events if isinstance(event, CommandFailed)]
        # A process that was killed, or did not understand its arguments, reports nothing.
        lines = reported or [line for line in self.talk.splitlines() if line.strip()]
        return lines[-1] if lines else f"it ended with code {self.code}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings that it reported."""
        from catseye.app.protocol.commands import CommandWarning

        return tuple(event.text for event in self.events if isinstance(event, CommandWarning))

    def document(self, kind: type[Written]) -> Written:
        """Return the JSON that it wrote, as the class from which it was written."""
        return kind.model_validate_json(self.out)

    def data(self) -> Any:
        """Return the JSON that it wrote: one value, or a list when it wrote several lines."""
        lines = [json.loads(line) for line in self.out.splitlines() if line.strip()]
        return lines[0] if len(lines) == 1 else lines


class Work(Protocol):
    """Runs commands."""

    async def do(self, *arguments: str | Path, heard: "Callable[[CommandEvent], None] | None" = None) -> Done:
        """Run a command to its end; cancelling ends the command.

        Args:
            arguments: of the command.
            heard: called with each event that the command reports.
        """
        ...


class Commands:
    """Implements `Work` with processes that give way to what measures."""

    async def do(self, *arguments: str | Path, heard: "Callable[[CommandEvent], None] | None" = None) -> Done:
        """Run a command to its end; cancelling ends the command."""
        return await do_command(tuple(map(str, arguments)), heard=heard, niceness=_NICENESS)


async def do_command(
    words: tuple[str, ...],
    *,
    heard: "Callable[[CommandEvent], None] | None" = None,
    told: Callable[[str], None] | None = None,
    started: Callable[[Signal], None] = lambda _signal: None,
    niceness: int = 0,
    end_by: int = signal.SIGINT,
    end_s: float = _END_S,
) -> Done:
    """Run a command to its end in a session of its own; cancelling ends it.

    Args:
        words: of the command, without `catseye`.
        heard: called with each event that the command reports.
        told: called with each line of data instead of keeping them all.
        started: called with what sends the process a signal; nothing becomes of one once it has ended.
        niceness: how far it gives way to other processes.
        end_by: signal that ends it when this is cancelled.
        end_s: how long it has for that, real s, before it is killed.
    """
    async with _pipe() as (reported, writing):
        try:
            process = await _started(words, writing, niceness)
        finally:
            os.close(writing)
        started(partial(_send, process))
        try:
            events, out, talk = await asyncio.gather(
                _events(reported, heard),
                _all(process.stdout) if told is None else _each(process.stdout, told),
                _all(process.stderr),
            )
            code = await process.wait()
        finally:
            if process.returncode is None:
                await _end(process, end_by, end_s)
    return Done(words, code, out, talk, events)


def command_line(arguments: tuple[str, ...]) -> str:
    """Return a command as somebody would type it."""
    return shlex.join(("catseye", *arguments))


async def _started(words: tuple[str, ...], writing: int, niceness: int) -> asyncio.subprocess.Process:
    """Start a command that reports on a descriptor."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-P",
        "-m",
        "catseye",
        *words,
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
        start_new_session=True,
        limit=_LONGEST_LINE,
        pass_fds=[writing],
        env={**os.environ, "NO_COLOR": "1", EVENTS_FD: str(writing)},
    )
    if niceness:
        with suppress(OSError):  # it may have ended
            os.setpriority(os.PRIO_PROCESS, process.pid, niceness)
    return process


@asynccontextmanager
async def _pipe() -> AsyncIterator[tuple[asyncio.StreamReader, int]]:
    """Open a pipe: a stream that ends with the context, and the descriptor to write to, which the caller closes."""
    reading, writing = os.pipe()
    stream = asyncio.StreamReader(limit=_LONGEST_LINE)
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(stream), os.fdopen(reading, "rb", 0)
    )
    try:
        yield stream, writing
    finally:
        transport.close()


async def _events(
    stream: asyncio.StreamReader, heard: "Callable[[CommandEvent], None] | None"
) -> "tuple[CommandEvent, ...]":
    """Return what a command reports; passes on each event as it comes."""
    from catseye.app.protocol.commands import command_event_of
    from catseye.app.protocol.message import MessageError, decode_object

    events: list[CommandEvent] = []
    while line := await stream.readline():
        # A command of a newer version may report more.
        with suppress(MessageError):
            events.append(event := command_event_of(decode_object(line)))
            if heard is not None:
                heard(event)
    return tuple(events)


async def _all(stream: asyncio.StreamReader | None) -> str:
    return "" if stream is None else (await stream.read()).decode(errors="replace")


async def _each(stream: asyncio.StreamReader | None, told: Callable[[str], None]) -> str:
    """Pass on each line as it comes; return nothing, for nothing is kept."""
    if stream is not None:
        while line := await stream.readline():
            told(line.decode(errors="replace").rstrip("\n"))
    return ""


def _send(process: asyncio.subprocess.Process, number: int) -> None:
    if process.returncode is None:
        with suppress(ProcessLookupError):
            process.send_signal(number)


async def _end(process: asyncio.subprocess.Process, by: int, within_s: float) -> None:
    _send(process, by)
    try:
        async with asyncio.timeout(within_s):
            await process.wait()
    except TimeoutError:
        _send(process, signal.SIGKILL)
        await process.wait()
