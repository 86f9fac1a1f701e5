"""An emulated LD5, written from the manual and not from the driver: `python -m norra_ld5.emulator [PORT]`."""

import asyncio
import sys
from collections.abc import Callable


class Display:
    """What the instrument knows, whoever asks."""

    def __init__(self) -> None:
        self.length_mm = 0.0
        self.beam = True
        self.lost = False
        self._zero_mm = 0.0
        self._commands: dict[str, Callable[[], str]] = {
            "ID": lambda: "NORRA LD5 EMULATOR,1.04,00217",
            "1TP": lambda: f"{self.length_mm - self._zero_mm:+012.6f}",
            "1TS": lambda: f"{self.beam:d},{self.lost:d},0,1,{80 if self.beam else 0:03d}",
            "1ZR": self._zero,
        }

    def interrupt(self) -> None:
        """Hold a hand into the beam."""
        self.beam, self.lost = False, True

    def restore(self) -> None:
        """Take the hand away; the latch stays."""
        self.beam = True

    def answer(self, line: str) -> str:
        """Return the answer to a command: its echo with the value, or a refusal."""
        command = self._commands.get(line)
        value = command() if command else "?A UNKNOWN COMMAND"
        return value if value.startswith("?") else line + value

    def _zero(self) -> str:
        if not self.beam:
            return "?C NO BEAM"
        self._zero_mm, self.lost = self.length_mm, False
        return ""


class Client(asyncio.Protocol):
    """One connection.

    Args:
        display: the instrument; all clients see the same one.
    """

    def __init__(self, display: Display) -> None:
        self._display = display
        self._buffer = b""
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take the client in."""
        if isinstance(transport, asyncio.Transport):
            self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Answer each complete line; CR, LF and CR LF end one. The buffer holds 255 characters, as the display's."""
        *lines, rest = (self._buffer + data).replace(b"\r", b"\n").split(b"\n")
        self._buffer = rest[-255:]
        for line in filter(None, lines):
            answer = self._display.answer(line[-255:].decode("latin-1"))
            if self._transport is not None:
                self._transport.write(answer.encode("latin-1") + b"\r\n")


async def listen(display: Display, port: int = 0) -> asyncio.Server:
    """Serve a display on a port of this computer; 0 takes a free one."""
    return await asyncio.get_running_loop().create_server(lambda: Client(display), "127.0.0.1", port)


async def main(port: int) -> None:
    """Serve until the process is ended."""
    server = await listen(Display(), port)
    sys.stdout.write(f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}\n")
    sys.stdout.flush()
    async with server:
        await server.serve_forever()


if __name__ == "__main__":
    asyncio.run(main(int(sys.argv[1]) if len(sys.argv) > 1 else 0))
