"""The transport over a TCP socket.

The socket is read directly, without asyncio's streams: a question and its answer take fewer turns of the loop, and
what has come unasked is seen without any.
"""

import asyncio
import os
import socket

from drivers.errors import LinkError
from drivers.inbox import Inbox

_CHUNK_BYTES = 65_536
_MOST_BYTES = 1 << 24


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
        self._socket: socket.socket | None = None
        self._inbox = Inbox(_MOST_BYTES)
        self._unsent = bytearray()
        self._sent: asyncio.Future[None] | None = None

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
        if self._socket:
            return
        try:
            async with asyncio.timeout(self._connect_timeout_s):
                self._socket = await self._connected()
        except TimeoutError:
            raise LinkError(
                f"{self.endpoint}: no connection within {self._connect_timeout_s:g} s: check that the "
                "instrument is switched on, its address and port, cable and firewall"
            ) from None
        except OSError as exc:
            # The numbers of a name that cannot be resolved are negative and have texts of their own.
            why = os.strerror(exc.errno) if exc.errno and exc.errno > 0 else exc.strerror or exc
            raise LinkError(
                f"{self.endpoint}: cannot connect ({why}): check that the instrument is switched on, its address "
                "and port, and that no other program holds its connection"
            ) from None
        self._inbox = Inbox(_MOST_BYTES)
        asyncio.get_running_loop().add_reader(self._socket, self._receive)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        if self._socket:
            self._give_up(LinkError(f"{self.endpoint}: the link was closed: connect again"))

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed or broken.
        """
        link = self._require_open()
        self._unsent += data
        if len(self._unsent) == len(data):
            self._flush(link)
        if self._unsent:
            await self._all_sent(link)
        self._require_open()

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: the link is closed, broken or the other side has closed it.
        """
        return self.waiting() or await self._inbox.read()

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the link is closed, broken or the other side has closed it.
        """
        chunk = self._inbox.take()
        if not chunk:
            self._require_open()
            self._receive()
            chunk = self._inbox.take()
        return chunk

    async def _connected(self) -> socket.socket:
        loop = asyncio.get_running_loop()
        try:
            places = socket.getaddrinfo(
                self._host, self._port, type=socket.SOCK_STREAM, flags=socket.AI_NUMERICHOST
            )
        except socket.gaierror:
            places = await loop.getaddrinfo(self._host, self._port, type=socket.SOCK_STREAM)
        failure: OSError = OSError("no such host")
        for family, kind, protocol, _, address in places:
            link = socket.socket(family, kind, protocol)
            try:
                link.setblocking(False)
                await loop.sock_connect(link, address)
                link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            except OSError as exc:
                link.close()
                failure = exc
            except BaseException:
                link.close()
                raise
            else:
                return link
        raise failure

    async def _all_sent(self, link: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        if self._sent is None or self._sent.done():
            self._sent = loop.create_future()
            loop.add_writer(link, self._flush, link)
        # Another writer may wait for the same bytes: a cancellation must not take the future from it.
        await asyncio.shield(self._sent)

    def _receive(self) -> None:
        """Take what has come from the socket."""
        if not self._socket:
            return
        try:
            data = self._socket.recv(_CHUNK_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as exc:
            self._give_up(self._broken(exc))
            return
        if not data:
            self._hear_no_more(
                "the other side has closed the connection: check the instrument and whether another program has "
                "connected to it"
            )
        elif not self._inbox.put(data):
            self._hear_no_more("bytes keep coming that nobody reads: check that this is the right instrument")

    def _hear_no_more(self, why: str) -> None:
        """End what can be read; a STOP may still be written to a peer that has closed one direction only."""
        self._inbox.end(LinkError(f"{self.endpoint}: {why}"))
        if self._socket:
            asyncio.get_running_loop().remove_reader(self._socket)

    def _flush(self, link: socket.socket) -> None:
        """Send what the socket takes."""
        try:
            count = link.send(self._unsent)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as exc:
            self._give_up(self._broken(exc))
            return
        del self._unsent[:count]
        if not self._unsent:
            self._end_writing()

    def _end_writing(self) -> None:
        if self._sent is not None and not self._sent.done():
            self._sent.set_result(None)
            if self._socket:
                asyncio.get_running_loop().remove_writer(self._socket)

    def _give_up(self, error: LinkError) -> None:
        """Close the socket; whoever reads or writes learns why."""
        self._inbox.end(error)
        self._unsent.clear()
        self._end_writing()
        if self._socket:
            asyncio.get_running_loop().remove_reader(self._socket)
            self._socket.close()
            self._socket = None

    def _require_open(self) -> socket.socket:
        if not self._socket:
            why = self._inbox.ended or f"{self.endpoint}: the link is not open: connect first"
            raise LinkError(str(why))
        return self._socket

    def _broken(self, exc: OSError) -> LinkError:
        return LinkError(
            f"{self.endpoint}: the connection broke ({exc.strerror or exc}): check cable and power"
        )
