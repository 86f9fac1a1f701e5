"""A conversation with a device over its raw link: lines of the terminal go out, its bytes are shown."""

import asyncio
import contextlib
import os
import sys
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import BinaryIO

from catseye.app.cli.output import note, write_line
from catseye.app.errors import SafetyError, UsageError
from catseye.app.guard.raw import raw_connection, raw_guard
from catseye.app.service.manual.raw_door import RawDoor, raw_door
from catseye.app.store.runs_folder import runs_folder
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.device import Entry
from catseye.drivers.roles.io import Io

_PRINTABLE = bytes(byte if 32 <= byte < 127 else ord(".") for byte in range(256))
_BYTES_A_LINE = 16


class Traffic:
    """Shows bytes as they pass, and keeps the same lines in a file.

    Args:
        log: the file, appended to.
    """

    def __init__(self, log: Path | None) -> None:
        self._clock = SystemClock()
        self._log: BinaryIO | None = None
        try:
            # Unbuffered: what was shown is in the file, however the program ends.
            self._log = log.open("ab", buffering=0) if log else None
        except OSError as error:
            raise UsageError(f"--log {log}: cannot be written: {error.strerror}") from error
        self.heard = asyncio.Event()

    def __enter__(self) -> "Traffic":
        return self

    def __exit__(self, *_: object) -> None:
        if self._log:
            self._log.close()

    def show(self, entry: Entry, data: bytes) -> None:
        """Show bytes with time and direction."""
        stamp = self._clock.now_utc().isoformat(timespec="microseconds")
        for start in range(0, len(data), _BYTES_A_LINE):
            part = data[start : start + _BYTES_A_LINE]
            text = part.translate(_PRINTABLE).decode("ascii")
            line = f"{stamp} {entry} {part.hex(' '):<{3 * _BYTES_A_LINE}}|{text}|"
            write_line(line)
            if self._log:
                _append(self._log, line)
        self.heard.set()


def _append(log: BinaryIO, line: str) -> None:
    try:
        log.write(line.encode() + b"\n")
    except OSError as error:
        raise UsageError(f"--log {log.name}: cannot be written: {error.strerror}") from error


@asynccontextmanager
async def guarded(endpoint: str, stop: bytes | None, traffic: Traffic) -> AsyncIterator[Transport]:
    """Open a connection to a robot, which nobody else moves and which is stopped when this program dies."""
    body = asyncio.current_task()
    stopped: list[str] = []

    def on_stop(reason: str) -> None:
        stopped.append(reason)
        if body is not None:
            body.cancel()

    # Whether it is an emulator is not known: nobody has asked.
    try:
        async with (
            raw_guard(endpoint, on_stop) as guard,
            raw_connection(
                guard, endpoint, stop, traffic.show, runs_folder(None), simulated=False, report=note
            ) as link,
        ):
            yield link
    except asyncio.CancelledError:
        if not stopped:
            raise
        raise SafetyError(stopped[0]) from None


async def converse(
    opened: Callable[[], AbstractAsyncContextManager[Transport]],
    traffic: Traffic,
    encode: Callable[[str], bytes],
    wait_s: float,
    io: Io | None,
    stop: bytes | None,
) -> None:
    """Talk until stdin ends and the device is quiet.

    Args:
        encode: returns the bytes of a typed line; ValueError for one that is not sent.
        wait_s: quiet for so long after the end of stdin, the conversation is over.
        io: says whether the door is closed; None when nobody has to know.
        stop: bytes that stop the arm when the door opens; None: its driver knows none.
    """
    async with opened() as link:
        try:
            if io is not None:
                await io.connect()
            async with raw_door(io, link, stop, SystemClock(), note) as door:
                await _pass_lines(link, traffic, _if_closed(door, encode), wait_s)
        finally:
            if io is not None:
                await io.close()


def _if_closed(door: RawDoor, encode: Callable[[str], bytes]) -> Callable[[str], bytes]:
    def encoded_if_closed(line: str) -> bytes:
        try:
            door.require_closed()
        except SafetyError as error:
            raise ValueError(str(error)) from error
        return encode(line)

    return encoded_if_closed


async def _pass_lines(
    link: Transport, traffic: Traffic, encode: Callable[[str], bytes], wait_s: float
) -> None:
    lines: asyncio.Queue[str | None] = asyncio.Queue()
    listening = asyncio.create_task(_listen(link))
    sending = asyncio.create_task(_send(link, lines, encode, traffic, wait_s))
    # Reading the standard input cannot be interrupted; the thread ends with the process.
    reader = threading.Thread(target=_read_lines, args=(lines, asyncio.get_running_loop()), daemon=True)
    reader.start()
    try:
        done, _ = await asyncio.wait({listening, sending}, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
    finally:
        listening.cancel()
        sending.cancel()
        await asyncio.gather(listening, sending, return_exceptions=True)


async def _listen(link: Transport) -> None:
    while True:
        await link.read()


async def _send(
    link: Transport,
    lines: asyncio.Queue[str | None],
    encode: Callable[[str], bytes],
    traffic: Traffic,
    wait_s: float,
) -> None:
    """Send each line; return when there are no more and the device has been quiet for a time."""
    while (line := await lines.get()) is not None:
        try:
            data = encode(line)
        except ValueError as error:
            if not sys.stdin.isatty():
                raise UsageError(f"not sent: {error}") from None
            note(f"not sent: {error}")
        else:
            await link.write(data)
    try:
        while True:
            traffic.heard.clear()
            async with asyncio.timeout(wait_s):
                await traffic.heard.wait()
    except TimeoutError:
        return


def _read_lines(lines: "asyncio.Queue[str | None]", loop: asyncio.AbstractEventLoop) -> None:
    """Hand over the lines of the standard input, then None; runs in a thread of its own."""
    rest = b""
    # The loop may have ended meanwhile; then nobody wants the input any more.
    with contextlib.suppress(RuntimeError):
        # Not through sys.stdin, whose lock would be held when the process ends.
        while data := os.read(0, 4096):
            *whole, rest = (rest + data).split(b"\n")
            for line in whole:
                loop.call_soon_threadsafe(lines.put_nowait, line.rstrip(b"\r").decode(errors="replace"))
        if rest:
            loop.call_soon_threadsafe(lines.put_nowait, rest.decode(errors="replace"))
        loop.call_soon_threadsafe(lines.put_nowait, None)
