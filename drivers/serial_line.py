"""The transport over a serial line.

pyserial waits in threads, never on the loop: one thread reads, another one opens, writes and closes.
"""

import asyncio
import errno
import os
import termios
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import serial

from drivers.errors import LinkError
from drivers.inbox import Inbox

Parity = Literal["N", "E", "O"]
StopBits = Literal["1", "1.5", "2"]
Handshake = Literal["none", "xonxoff", "rtscts"]

_MOST_BYTES = 1 << 20
_KERNEL_BYTES = 4096
_CLOSE_TIMEOUT_S = 2.0
_PSEUDO_TERMINALS = "/dev/pts/"


@dataclass(frozen=True)
class LineSettings:
    """How bytes go over the line.

    Attributes:
        baud: symbols a second.
        parity: none, even or odd.
        bits: data bits of a byte.
        stopbits: stop bits.
        handshake: none, by characters or by lines.
    """

    baud: int = 9600
    parity: Parity = "N"
    bits: Literal[7, 8] = 8
    stopbits: StopBits = "1"
    handshake: Handshake = "none"

    @property
    def query(self) -> str:
        """The settings as an endpoint has them."""
        handshake = "" if self.handshake == "none" else f"&handshake={self.handshake}"
        line = f"baud={self.baud}&parity={self.parity}&bits={self.bits}&stopbits={self.stopbits}"
        return line + handshake


@dataclass(frozen=True)
class _Opened:
    """An open port with its threads."""

    port: serial.Serial
    reader: threading.Thread
    worker: ThreadPoolExecutor
    closing: threading.Event


def is_pseudo_terminal(device: str) -> bool:
    """Return whether a port is an emulated one, which knows neither parity nor 7 bits."""
    return os.path.realpath(device).startswith(_PSEUDO_TERMINALS)


class SerialTransport:
    """A serial port, held by nobody else while it is open.

    Args:
        device: path of the port.
        settings: of the line.
        open_timeout_s: how long opening may take, real s.
        write_timeout_s: how long the line may take nothing, real s.
    """

    def __init__(
        self,
        device: str,
        settings: LineSettings,
        *,
        open_timeout_s: float = 5.0,
        write_timeout_s: float = 1.0,
    ) -> None:
        self._device = device
        self._settings = settings
        self._open_timeout_s = open_timeout_s
        # The kernel's buffer may be full of bytes that the line still has to carry.
        self._write_timeout_s = write_timeout_s + 12 * _KERNEL_BYTES / settings.baud
        self._opened: _Opened | None = None
        self._inbox = Inbox(_MOST_BYTES)

    @property
    def endpoint(self) -> str:
        """Where it leads: serial:///path?baud=…&parity=…&bits=…&stopbits=…."""
        return f"serial://{self._device}?{self._settings.query}"

    async def open(self) -> None:
        """Open the port; one that is open is kept.

        Raises:
            LinkError: missing, not permitted, held by another program, or wrong settings for it.
        """
        if self._opened:
            return
        worker = ThreadPoolExecutor(1, thread_name_prefix="serial-line")
        work = worker.submit(self._open_port)
        try:
            async with asyncio.timeout(self._open_timeout_s):
                port = await asyncio.wrap_future(work)
        except BaseException as exc:
            work.add_done_callback(_close_late)
            worker.shutdown(wait=work.done())
            if isinstance(exc, OSError | ValueError | termios.error):
                raise self._not_opened(exc) from None
            raise
        self._inbox = Inbox(_MOST_BYTES)
        closing = threading.Event()
        arguments = (port, self._inbox, asyncio.get_running_loop(), closing)
        reader = threading.Thread(target=self._read_on, args=arguments, name="serial-read", daemon=True)
        self._opened = _Opened(port, reader, worker, closing)
        reader.start()

    async def close(self) -> None:
        """Close the port within a bounded time; may be called any number of times."""
        if not self._opened:
            return
        opened, self._opened = self._opened, None
        self._inbox.end(LinkError(f"{self.endpoint}: the link was closed: connect again"))
        opened.closing.set()
        opened.port.cancel_write()
        opened.port.cancel_read()
        closing = opened.worker.submit(_shut, opened)
        try:
            await asyncio.wait({asyncio.wrap_future(closing)}, timeout=_CLOSE_TIMEOUT_S)
        finally:
            # A driver of the operating system that does not let go keeps its thread, not this program.
            opened.worker.shutdown(wait=closing.done())

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed or broken, or the line takes no bytes.
        """
        opened = self._require_open()
        try:
            count = await asyncio.wrap_future(opened.worker.submit(opened.port.write, data))
        except serial.SerialTimeoutException:
            count = 0
        except OSError as exc:
            raise self._broken(exc) from None
        if count != len(data):
            raise LinkError(
                f"{self.endpoint}: the line does not take bytes: check cable, power and the instrument's handshake"
            )

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: the link is closed or broken.
        """
        return self.waiting() or await self._inbox.read()

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the link is closed or broken.
        """
        chunk = self._inbox.take()
        self._require_open()
        return chunk

    def _open_port(self) -> serial.Serial:
        s = self._settings
        # A pseudo-terminal carries whole bytes and refuses to be told otherwise.
        emulated = is_pseudo_terminal(self._device)
        return serial.Serial(
            self._device,
            baudrate=s.baud,
            bytesize=8 if emulated else s.bits,
            parity="N" if emulated else s.parity,
            stopbits=float(s.stopbits),
            xonxoff=s.handshake == "xonxoff",
            rtscts=s.handshake == "rtscts",
            write_timeout=self._write_timeout_s,
            exclusive=True,
        )

    def _read_on(
        self, port: serial.Serial, inbox: Inbox, loop: asyncio.AbstractEventLoop, closing: threading.Event
    ) -> None:
        """Hand over what comes until the port is closed or breaks; runs in a thread of its own."""
        try:
            # Under a steady stream the cancellation of a read may be swallowed by the one that takes the rest.
            while (first := port.read(1)) and not closing.is_set():
                loop.call_soon_threadsafe(self._arrived, inbox, first + port.read(port.in_waiting))
        except OSError as exc:
            if not closing.is_set():
                loop.call_soon_threadsafe(inbox.end, self._broken(exc))

    def _arrived(self, inbox: Inbox, data: bytes) -> None:
        if not inbox.put(data):
            inbox.end(LinkError(f"{self.endpoint}: bytes keep coming that nobody reads: connect again"))

    def _require_open(self) -> _Opened:
        if not self._opened:
            raise LinkError(str(self._inbox.ended or f"{self.endpoint}: the link is not open: connect first"))
        return self._opened

    def _not_opened(self, exc: BaseException) -> LinkError:
        number = getattr(exc, "errno", None)
        if isinstance(exc, TimeoutError):
            why = f"not open within {self._open_timeout_s:g} s"
        elif number == errno.EAGAIN:
            why = "another program holds it"
        else:
            why = os.strerror(number) if number else str(exc)
        return LinkError(
            f"{self.endpoint}: cannot open the serial port ({why}): check that the adapter is plugged in, the path "
            "(/dev/serial/by-id/… stays the same), that you may use it (group dialout), its settings, and that no "
            "other program holds it"
        )

    def _broken(self, exc: OSError) -> LinkError:
        return LinkError(
            f"{self.endpoint}: the serial port broke ({exc}): check that the adapter is plugged in, cable and power"
        )


def _close_late(work: "Future[serial.Serial]") -> None:
    """Close a port that was opened after nobody waited for it any more."""
    if not work.cancelled() and work.exception() is None:
        work.result().close()


def _shut(opened: _Opened) -> None:
    opened.reader.join(_CLOSE_TIMEOUT_S)
    opened.port.close()
