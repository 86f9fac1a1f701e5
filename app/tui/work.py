"""Work on stored data: the commands of `catseye`, each in a process of its own."""

import asyncio
import json
import os
import shlex
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

_LONGEST_LINE = 64 * 1024 * 1024
_END_S = 5.0


@dataclass(frozen=True)
class Done:
    """How a command ended.

    Attributes:
        arguments: of the command, without its name.
        code: exit code, as docs and `catseye` have them.
        out: data that it wrote.
        talk: what it said to people.
    """

    arguments: tuple[str, ...]
    code: int
    out: str
    talk: str

    @property
    def line(self) -> str:
        """The command as somebody would type it."""
        return command_line(self.arguments)

    @property
    def fault(self) -> str:
        """What it said last; empty when all is well."""
        if self.code == 0:
            return ""
        lines = [line for line in self.talk.strip().splitlines() if line.strip()]
        return lines[-1].removeprefix("catseye: ") if lines else f"it ended with code {self.code}"

    def data(self) -> Any:
        """Return the JSON that it wrote: one value, or a list when it wrote several lines."""
        lines = [json.loads(line) for line in self.out.splitlines() if line.strip()]
        return lines[0] if len(lines) == 1 else lines


class Work(Protocol):
    """Runs commands."""

    async def do(self, *arguments: str | Path, talk: Callable[[str], None] | None = None) -> Done:
        """Run a command to its end; `talk` is given what it says as it says it. Cancelling ends the command."""
        ...


class Commands:
    """Implements `Work` with processes."""

    async def do(self, *arguments: str | Path, talk: Callable[[str], None] | None = None) -> Done:
        """Run a command to its end; cancelling ends the command."""
        words = tuple(str(argument) for argument in arguments)
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
            env={**os.environ, "NO_COLOR": "1"},
        )
        try:
            out, said = await asyncio.gather(_all(process.stdout, None), _all(process.stderr, talk))
            code = await process.wait()
        finally:
            if process.returncode is None:
                await _end(process)
        return Done(words, code, out, said)


def command_line(arguments: tuple[str, ...]) -> str:
    """Return a command as somebody would type it."""
    return shlex.join(("catseye", *arguments))


async def _all(stream: asyncio.StreamReader | None, heard: Callable[[str], None] | None) -> str:
    if stream is None:
        return ""
    parts: list[bytes] = []
    while chunk := await stream.read(65536):
        parts.append(chunk)
        if heard is not None:
            heard(chunk.decode(errors="replace"))
    return b"".join(parts).decode(errors="replace")


async def _end(process: asyncio.subprocess.Process) -> None:
    with suppress(ProcessLookupError):
        process.send_signal(signal.SIGINT)
    try:
        async with asyncio.timeout(_END_S):
            await process.wait()
    except TimeoutError:
        with suppress(ProcessLookupError):
            process.kill()
        await process.wait()
