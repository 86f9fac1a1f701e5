"""The transport over a TCP socket."""

import asyncio
import contextlib
import socket

from drivers.errors import LinkError

_CHUNK_BYTES = 4096
_CLOSE_TIMEOUT_S = 1.0


class TcpTransport:
    """A client socket without Nagle's delay.

    Args:
        host: name or address of the instrument.
        port: its port.
        connect_timeout_s: how long connecting may take, s.
    """

    def __init__(self, host: str, port: int, *, connect_timeout_s: float = 5.0) -> None:
        self._host = host
        self._port = port
        self._connect_timeout_s = connect_timeout_s
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    @property
    def endpoint(self) -> str:
        """Where it leads: tcp://host:port."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"tcp://{host}:{self._port}"

    async def open(self) -> None:
        """Connect; an open link is kept.

        Raises:
            LinkError: unreachable; the text names the endpoint and what to check.
        """
        if self._streams:
            return
        try:
            async with asyncio.timeout(self._connect_timeout_s):
                reader, writer = await asyncio.open_connection(self._host, self._port)
        except TimeoutError:
            raise LinkError(
                f"{self.endpoint}: no connection within {self._connect_timeout_s:g} s: check that the "
                "instrument is switched on, its address and port, cable and firewall"
            ) from None
        except OSError as exc:
            raise LinkError(
                f"{self.endpoint}: cannot connect ({exc.strerror or exc}): check that the instrument is "
                "switched on, its address and port, and that no other program holds its connection"
            ) from None
        writer.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._streams = reader, writer

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        if not self._streams:
            return
        _, writer = self._streams
        self._streams = None
        writer.close()
        # The socket is given up either way; a peer that reset it or does not answer changes nothing.
        with contextlib.suppress(OSError, TimeoutError):
            async with asyncio.timeout(_CLOSE_TIMEOUT_S):
                await writer.wait_closed()

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed or broken.
        """
        _, writer = self._require_open()
        try:
            writer.write(data)
            await writer.drain()
        except OSError as exc:
            raise self._broken(exc) from None

    async def read(self) -> bytes:
        """Return the next chunk, 1 to 4096 bytes.

        Raises:
            LinkError: the link is closed, broken or the other side has closed it.
        """
        reader, _ = self._require_open()
        try:
            data = await reader.read(_CHUNK_BYTES)
        except OSError as exc:
            raise self._broken(exc) from None
        if not data:
            raise LinkError(
                f"{self.endpoint}: the other side has closed the connection: check the instrument and "
                "whether another program has connected to it"
            )
        return data

    def _require_open(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        if not self._streams:
            raise LinkError(f"{self.endpoint}: the link is not open: connect first")
        return self._streams

    def _broken(self, exc: OSError) -> LinkError:
        return LinkError(
            f"{self.endpoint}: the connection broke ({exc.strerror or exc}): check cable and power"
        )
