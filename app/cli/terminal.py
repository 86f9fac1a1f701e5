"""terminal: the raw traffic of one device, in hex and text."""

import asyncio
import contextlib
import difflib
import os
import re
import sys
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from pathlib import Path
from typing import BinaryIO, Literal

from catseye.app.bench.raw_door import RawDoor, raw_door
from catseye.app.cell.bench import may_move_an_arm
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cli.output import emit, say
from catseye.app.engine.interlock import RemoteIo
from catseye.app.errors import SafetyError, UsageError
from catseye.app.guard.raw import plain_connection, raw_connection, raw_guard
from catseye.app.instruments import device_builder, stop_request
from catseye.app.runs_folder import runs_folder
from catseye.drivers.links.record import Direction
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import SystemClock

LineEnd = Literal["cr", "lf", "crlf", "none"]

_ENDS: dict[LineEnd, bytes] = {"cr": b"\r", "lf": b"\n", "crlf": b"\r\n", "none": b""}
_ESCAPES = {"r": "\r", "n": "\n", "t": "\t", "e": "\x1b", "\\": "\\"}
_ESCAPE = re.compile(r"\\(?:x(?P<code>[0-9A-Fa-f]{2})|(?P<letter>.)|$)")
_PRINTABLE = bytes(byte if 32 <= byte < 127 else ord(".") for byte in range(256))
_BYTES_A_LINE = 16


def terminal_command(
    device: str,
    file: Path,
    eol: LineEnd | None,
    as_hex: bool,
    log: Path | None,
    wait_s: float,
    arm: str | None,
) -> None:
    """Talk until stdin ends and the device is quiet."""
    cell = load_cell(file).cell
    endpoint = endpoint_of(cell, device)
    may_send = _may_send(cell, device, arm)
    encode = _encoder(eol or ("none" if as_hex else "crlf"), as_hex)
    with _Traffic(log) as traffic:
        say(f"{device} at {endpoint}; a line of input is sent, Ctrl-C ends")
        if arm is not None:
            say(
                "what you start by hand goes on when the terminal ends: stop it yourself; this is no emergency stop"
            )
        if not may_send:
            say(f"listening only: what is sent may move the robot; --arm {cell.name} lets it pass")
        io = None
        if may_send and _moves(cell, device):
            link = partial(_guarded, endpoint, _stop(cell, device), traffic)
            io = device_builder(cell, SystemClock())(_ignore).io
        else:
            link = partial(plain_connection, endpoint, traffic.show)
        asyncio.run(_converse(link, traffic, encode if may_send else _refusal(cell), wait_s, io))


def endpoint_of(cell: Cell, device: str) -> str:
    """Return where a device of the cell is.

    Raises:
        UsageError: the cell has no such device; the text names the nearest one.
    """
    places = {
        "robot": cell.robot.endpoint,
        "interferometer": cell.interferometer.endpoint,
        "environment": cell.environment.endpoint,
        **({"tracker": cell.tracker.endpoint} if cell.tracker else {}),
        **{further.name: further.endpoint for further in cell.device},
    }
    if device in places:
        return places[device]
    near = difflib.get_close_matches(device, places, n=1, cutoff=0.5)
    meant = f"did you mean {near[0]}? " if near else ""
    raise UsageError(f"the cell has no device {device!r}: {meant}there are {', '.join(places)}")


def encoded(line: str, end: LineEnd, *, as_hex: bool) -> bytes:
    r"""Return the bytes that a line of input stands for.

    Args:
        line: hex digits, or text with the escapes \r \n \t \e \\ and \xNN.
        end: what is put behind it.
        as_hex: which of both.

    Raises:
        ValueError: it is neither; the text says what is wrong.
    """
    if as_hex:
        try:
            return bytes.fromhex(line) + _ENDS[end]
        except ValueError:
            raise ValueError(f"{line!r} is no row of hex bytes such as 31 3b 0d") from None
    try:
        return _ESCAPE.sub(_unescaped, line).encode("latin-1") + _ENDS[end]
    except UnicodeEncodeError as error:
        raise ValueError(f"{error.object[error.start]!r} is no single byte; write it as \\xNN") from None


def _unescaped(match: re.Match[str]) -> str:
    if match["code"]:
        return chr(int(match["code"], 16))
    if match["letter"] not in _ESCAPES:
        raise ValueError(f"{match[0]!r} is no escape; there are \\r \\n \\t \\e \\xNN and \\\\")
    return _ESCAPES[match["letter"]]


def _may_send(cell: Cell, device: str, arm: str | None) -> bool:
    if arm not in {None, cell.name}:
        raise SafetyError(
            f"--arm names {arm!r} and the cell is {cell.name!r}: nothing was sent; check which robot it is"
        )
    return arm is not None or not _moves(cell, device)


def _moves(cell: Cell, device: str) -> bool:
    return may_move_an_arm(device, _driver(cell, device))


def _driver(cell: Cell, device: str) -> str:
    """Return the driver of a device that may be a robot, empty for those that are none."""
    drivers = {"robot": cell.robot.driver, **{further.name: further.driver for further in cell.device}}
    return drivers.get(device, "")


def _stop(cell: Cell, device: str) -> bytes | None:
    """Return the bytes that stop the arm behind a device; None where nobody knows any."""
    settings = {"robot": cell.robot.settings, **{further.name: further.settings for further in cell.device}}
    return stop_request(_driver(cell, device), device, settings[device])


@asynccontextmanager
async def _guarded(endpoint: str, stop: bytes | None, traffic: "_Traffic") -> AsyncIterator[Transport]:
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
                guard, endpoint, stop, traffic.show, runs_folder(None), simulated=False, tell=say
            ) as link,
        ):
            yield link
    except asyncio.CancelledError:
        if not stopped:
            raise
        raise SafetyError(stopped[0]) from None


def _encoder(end: LineEnd, as_hex: bool) -> Callable[[str], bytes]:
    return lambda line: encoded(line, end, as_hex=as_hex)


def _refusal(cell: Cell) -> Callable[[str], bytes]:
    def refuse(_line: str) -> bytes:
        raise ValueError(f"the robot may move: start the terminal with --arm {cell.name} to send to it")

    return refuse


class _Traffic:
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

    def __enter__(self) -> "_Traffic":
        return self

    def __exit__(self, *_: object) -> None:
        if self._log:
            self._log.close()

    def show(self, direction: Direction, data: bytes) -> None:
        """Show bytes with time and direction."""
        stamp = self._clock.now_utc().isoformat(timespec="microseconds")
        for start in range(0, len(data), _BYTES_A_LINE):
            part = data[start : start + _BYTES_A_LINE]
            text = part.translate(_PRINTABLE).decode("ascii")
            line = f"{stamp} {direction} {part.hex(' '):<{3 * _BYTES_A_LINE}}|{text}|"
            emit(line)
            if self._log:
                _append(self._log, line)
        self.heard.set()


def _append(log: BinaryIO, line: str) -> None:
    try:
        log.write(line.encode() + b"\n")
    except OSError as error:
        raise UsageError(f"--log {log.name}: cannot be written: {error.strerror}") from error


async def _converse(
    opened: Callable[[], AbstractAsyncContextManager[Transport]],
    traffic: _Traffic,
    encode: Callable[[str], bytes],
    wait_s: float,
    io: RemoteIo | None,
) -> None:
    async with opened() as link:
        try:
            if io is not None:
                await io.connect()
            async with raw_door(io, link, SystemClock(), lambda text: say(f"{text}; STOP was sent")) as door:
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
    link: Transport, traffic: _Traffic, encode: Callable[[str], bytes], wait_s: float
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
    traffic: _Traffic,
    wait_s: float,
) -> None:
    """Send each line; return when there are no more and the device has been quiet for a time."""
    while (line := await lines.get()) is not None:
        try:
            data = encode(line)
        except ValueError as error:
            if not sys.stdin.isatty():
                raise UsageError(f"not sent: {error}") from None
            say(f"not sent: {error}")
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


def _ignore(_device: str, _direction: str, _data: bytes) -> None:
    return
