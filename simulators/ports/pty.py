"""A serial line as a pseudo-terminal, with the byte time of the line in both directions.

What a pseudo-terminal cannot show: rate, parity, framing errors, break, modem lines and hardware handshake. Two
things are only seen in part:

* A client is known by its first byte. When it closes the port after that, its session ends and the next client
  has a new one. A client that never sends, or that closes and opens within a turn of the emulator's loop, is not
  distinguished from its successor, as on any line with three wires.
* Output that nobody reads stays in the terminal until its 4 KiB are full; a client that wants only what is new
  empties its input when it opens the port (pyserial does).
"""

import asyncio
import os
import termios
import tty
from collections.abc import Callable
from pathlib import Path

from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.address import LineAddress
from catseye.simulators.ports.conversation import Conversation, Wire
from catseye.simulators.ports.pacer import Pacer
from catseye.simulators.world.timekeeper import TimeKeeper

ANY_FREE = "/dev/ptmx"
_TERMINALS = "/dev/pts/"
_CHUNK_BYTES = 1024
_IN_BYTES = 4096
_OUT_BYTES = 65_536


class LineListener:
    """One serial line; who opens it is its client."""

    def __init__(
        self,
        address: LineAddress,
        device: str,
        keeper: TimeKeeper,
        converse: Callable[[Wire], Conversation],
    ) -> None:
        self._address = address
        self._device = device
        self._keeper = keeper
        self._converse = converse
        self._line: _Line | None = None
        self._name = ""

    @property
    def endpoint(self) -> str:
        """Where clients find it."""
        path = self._name if self._address.path == ANY_FREE else self._address.path
        return f"serial://{path}{self._address.query}"

    async def open(self) -> None:
        """Take a pseudo-terminal and put a link to it at the path.

        Raises:
            EmulatorError: something else stands at the path.
            OSError: there is no pseudo-terminal left, or the link cannot be made.
        """
        self._check_path()
        self._plug_in()

    def drop(self) -> None:
        """Pull the cable of the adapter and put it in again; a line from /dev/ptmx may get another name."""
        if self._line is not None:
            self._line.close()
            self._plug_in()

    async def close(self) -> None:
        """Give the pseudo-terminal back and remove the link."""
        if self._line is None:
            return
        line, self._line = self._line, None
        line.close()
        await line.conversation.gone
        self._remove_link()

    def _plug_in(self) -> None:
        self._line = _Line(lambda: self._address.byte_s / self._keeper.speed, self._converse)
        self._name = self._line.name
        path = Path(self._address.path)
        if self._address.path == ANY_FREE:
            return
        try:
            path.unlink(missing_ok=True)
            path.symlink_to(self._name)
        except OSError:
            self._line.close()
            raise

    def _remove_link(self) -> None:
        """Remove the link, unless another emulator has put its own there meanwhile."""
        path = Path(self._address.path)
        if path.is_symlink() and os.readlink(path) == self._name:
            path.unlink()

    def _check_path(self) -> None:
        path = Path(self._address.path)
        if self._address.path == ANY_FREE:
            return
        if path.is_symlink():
            target = os.readlink(path)
            if not path.exists() or target.startswith(_TERMINALS):
                return
            what = f"is a link to {target}"
        elif path.exists():
            what = "is a real device or file"
        elif not path.parent.is_dir():
            what = "is in a folder that does not exist"
        else:
            return
        raise EmulatorError(
            f"{self._device}: cannot emulate a serial line at {path}: it {what}; choose a path where nothing "
            f"stands, or {ANY_FREE} for a free pseudo-terminal"
        )


class _Line:
    """A pseudo-terminal and the conversation over it.

    Args:
        byte_s: returns the real time of one byte, s.
    """

    def __init__(self, byte_s: Callable[[], float], converse: Callable[[Wire], Conversation]) -> None:
        self._loop = asyncio.get_running_loop()
        self._converse = converse
        self._master, slave = os.openpty()
        self._slave: int | None = slave
        tty.setraw(self._master)
        _make_plain(slave)
        os.set_blocking(self._master, False)
        self.name = os.ttyname(slave)
        self._in = Pacer(byte_s, self._arrived, _IN_BYTES)
        self._out = Pacer(byte_s, self._emit, _OUT_BYTES)
        self._choked = False
        self.conversation = converse(self)
        self._listen()

    @property
    def gap_s(self) -> float:
        """Longest real time, s, between two pieces of what a client sent without a pause."""
        return self._in.gap_s

    def send(self, data: bytes) -> None:
        """Put bytes on the line."""
        self._out.put(data)

    def pause(self) -> None:
        """Leave what the client sends in the terminal."""
        self._choked = True
        self._listen()

    def resume(self) -> None:
        """Go on taking."""
        self._choked = False
        self._listen()

    def hang_up(self) -> None:
        """A line knows no connection."""

    def close(self) -> None:
        """Give the pseudo-terminal back; whoever has it open sees the end."""
        self._loop.remove_reader(self._master)
        self._in.clear()
        self._out.clear()
        master, self._master = self._master, -1
        os.close(master)
        if self._slave is not None:
            os.close(self._slave)
            self._slave = None
        self.conversation.end()

    def _listen(self) -> None:
        """Read the terminal while there is room for what comes."""
        if self._master < 0:
            return
        if self._choked or self._in.room_bytes < _CHUNK_BYTES:
            self._loop.remove_reader(self._master)
        else:
            self._loop.add_reader(self._master, self._readable)

    def _readable(self) -> None:
        try:
            data = os.read(self._master, _CHUNK_BYTES)
        except BlockingIOError:
            return
        except OSError:
            self._hung_up()
            return
        if self._slave is not None:
            # The client holds the line open; without this descriptor its closing can be seen.
            os.close(self._slave)
            self._slave = None
        self._in.put(data)
        self._listen()

    def _hung_up(self) -> None:
        """Keep the line alive for the next client and start anew."""
        self._slave = os.open(self.name, os.O_RDWR | os.O_NOCTTY)
        _make_plain(self._slave)
        self._in.clear()
        self._out.clear()
        self.conversation.end()
        self._choked = False
        self.conversation = self._converse(self)
        self._listen()

    def _arrived(self, data: bytes) -> None:
        self.conversation.feed(data)
        self._listen()

    def _emit(self, data: bytes) -> None:
        try:
            os.write(self._master, data)
        except OSError:
            # Nobody reads, or the client has just gone: the bytes are lost, as on a real line.
            return


def _make_plain(terminal: int) -> None:
    """Switch off echo and line editing, which terminals begin with, and set a rate that no client asks for.

    A pseudo-terminal drops parity and 7 bits. The C library calls that an error for a client whose settings
    change nothing else; with this rate there is always something that changes.
    """
    tty.setraw(terminal)
    attributes = termios.tcgetattr(terminal)
    attributes[4] = attributes[5] = termios.B50
    termios.tcsetattr(terminal, termios.TCSANOW, attributes)
