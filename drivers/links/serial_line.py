"""The transport over a serial line.

pyserial opens and closes the port, in a thread, since a driver of the operating system may hang there. Bytes go
through its descriptor on the loop.
"""

import asyncio
import errno
import os
import termios
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import serial

from catseye.drivers.links.channel import Channel, ChannelTransport
from catseye.drivers.roles.errors import LinkError

Parity = Literal["N", "E", "O"]
StopBits = Literal["1", "1.5", "2"]
Handshake = Literal["none", "xonxoff", "rtscts"]

_KERNEL_BYTES = 4096
_CLOSE_TIMEOUT_S = 2.0
_PLUG_IN = "check that the adapter is plugged in, cable and power"
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

    @property
    def character_s(self) -> float:
        """How long a byte takes with its start, parity and stop bits."""
        return (1 + self.bits + (self.parity != "N") + float(self.stopbits)) / self.baud


def is_pseudo_terminal(device: str) -> bool:
    """Return whether a port is an emulated one, which knows neither parity nor 7 bits."""
    return os.path.realpath(device).startswith(_PSEUDO_TERMINALS)


class SerialTransport(ChannelTransport):
    """A serial port, held by nobody else while it is open.

    Args:
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
        super().__init__()
        self._device = device
        self._settings = settings
        self._open_timeout_s = open_timeout_s
        # The kernel's buffer may be full of bytes that the line still has to carry.
        self._write_timeout_s = write_timeout_s + 12 * _KERNEL_BYTES / settings.baud
        self._port: serial.Serial | None = None

    @property
    def endpoint(self) -> str:
        """Where it leads: serial:///path?baud=…&parity=…&bits=…&stopbits=…."""
        return f"serial://{self._device}?{self._settings.query}"

    async def open(self) -> None:
        """Open the port; one that is open is kept.

        Raises:
            LinkError: missing, not permitted, held by another program, or wrong settings for it.
        """
        if self._is_open():
            return
        await self.close()
        worker = ThreadPoolExecutor(1, thread_name_prefix="serial-line")
        work = worker.submit(self._open_port)
        try:
            async with asyncio.timeout(self._open_timeout_s):
                self._port = await asyncio.wrap_future(work)
        except BaseException as exc:
            work.add_done_callback(_close_late)
            if isinstance(exc, OSError | ValueError | termios.error):
                raise self._not_opened(exc) from None
            raise
        finally:
            worker.shutdown(wait=work.done())
        self._channel = Channel(
            self._port.fileno(),
            self.endpoint,
            ended=f"the serial port broke (it is gone): {_PLUG_IN}",
            broken=_broken,
        )

    async def close(self) -> None:
        """Close the port within a bounded time; may be called any number of times."""
        self._let_go()
        port, self._port = self._port, None
        if not port:
            return
        worker = ThreadPoolExecutor(1, thread_name_prefix="serial-line")
        closing = worker.submit(port.close)
        try:
            await asyncio.wait({asyncio.wrap_future(closing)}, timeout=_CLOSE_TIMEOUT_S)
        finally:
            # A driver of the operating system that does not let go keeps its thread, not this program.
            worker.shutdown(wait=closing.done())

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed or broken, or the line takes no bytes.
        """
        try:
            async with asyncio.timeout(self._write_timeout_s):
                await super().write(data)
        except TimeoutError:
            raise LinkError(
                f"{self.endpoint}: the line does not take bytes: check cable, power and the instrument's handshake"
            ) from None

    def _open_port(self) -> serial.Serial:
        s = self._settings
        # A pseudo-terminal carries whole bytes and refuses other settings.
        emulated = is_pseudo_terminal(self._device)
        return serial.Serial(
            self._device,
            baudrate=s.baud,
            bytesize=8 if emulated else s.bits,
            parity="N" if emulated else s.parity,
            stopbits=float(s.stopbits),
            xonxoff=s.handshake == "xonxoff",
            rtscts=s.handshake == "rtscts",
            # VMIN 1 and VTIME 0: reading nothing then means that the port is gone, not that nothing has come.
            inter_byte_timeout=0,
            exclusive=True,
        )

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


def _broken(exc: OSError) -> str:
    return f"the serial port broke ({exc.strerror or exc}): {_PLUG_IN}"


def _close_late(work: "Future[serial.Serial]") -> None:
    """Close a port that was opened after nobody waited for it any more."""
    if not work.cancelled() and work.exception() is None:
        work.result().close()
