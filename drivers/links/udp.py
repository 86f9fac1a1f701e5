"""The transport over datagrams: a write is one datagram, a read returns one."""

import asyncio
import socket

from catseye.drivers.links.inbox import Inbox
from catseye.drivers.links.transport import socket_endpoint
from catseye.drivers.roles.errors import LinkError

_LARGEST_BYTES = 65_536
_MOST_BYTES = 1 << 20
_RESOLVE_TIMEOUT_S = 5.0


class UdpTransport:
    """A socket that talks with one address.

    Attributes:
        lost_datagrams: how many came while the queue of those that nobody had read was full; bounded at 1 MiB.
    """

    def __init__(self, host: str, port: int) -> None:
        self._host = host
        self._port = port
        self._socket: socket.socket | None = None
        self._inbox = Inbox(_MOST_BYTES)
        self.lost_datagrams = 0

    @property
    def endpoint(self) -> str:
        """Where it leads: udp://host:port."""
        return socket_endpoint("udp", self._host, self._port)

    async def open(self) -> None:
        """Take a local port; nothing is sent, so a missing instrument shows with the first datagram.

        Raises:
            LinkError: the name is unknown or the network is not there.
        """
        if self._socket:
            return
        loop = asyncio.get_running_loop()
        link: socket.socket | None = None
        try:
            async with asyncio.timeout(_RESOLVE_TIMEOUT_S):
                places = await loop.getaddrinfo(self._host, self._port, type=socket.SOCK_DGRAM)
            family, kind, protocol, _, address = places[0]
            link = socket.socket(family, kind, protocol)
            link.setblocking(False)
            link.connect(address)
        except OSError as exc:
            if link:
                link.close()
            why = exc.strerror or str(exc) or "its name is not resolved in time"
            raise LinkError(
                f"{self.endpoint}: cannot be reached ({why}): check address, cable and network"
            ) from None
        self._socket = link
        self._inbox = Inbox(_MOST_BYTES)
        loop.add_reader(link, self._receive)

    async def close(self) -> None:
        """Give the socket back; may be called any number of times."""
        if self._socket:
            self._inbox.end(LinkError(f"{self.endpoint}: the link was closed: connect again"))
            asyncio.get_running_loop().remove_reader(self._socket)
            self._socket.close()
            self._socket = None

    async def write(self, data: bytes) -> None:
        """Send one datagram.

        Raises:
            LinkError: the link is closed, or the network takes no datagram.
        """
        self.send_urgent(data)

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Send one datagram; none ever waits here, so nothing is cut.

        Raises:
            LinkError: the link is closed, or the network takes no datagram.
        """
        del cut
        link = self._require_open()
        try:
            link.send(data)
        except OSError as exc:
            raise self._refused(exc) from None

    def note_heal(self, why: str) -> None:
        """Note nothing: no transcript is kept here."""
        del why

    def fileno(self) -> int:
        """Return the descriptor.

        Raises:
            LinkError: the link is closed.
        """
        return self._require_open().fileno()

    async def read(self) -> bytes:
        """Return the next datagram.

        Raises:
            LinkError: the link is closed, or nobody listens there.
        """
        return self.waiting() or await self._inbox.read()

    def waiting(self) -> bytes:
        """Return a datagram that has come, empty bytes when none has.

        Raises:
            LinkError: the link is closed, or nobody listens there.
        """
        datagram = self._inbox.take()
        if not datagram and not self._inbox.spent:
            self._require_open()
            self._receive()
            datagram = self._inbox.take()
        return datagram

    def _receive(self) -> None:
        if not self._socket:
            return
        try:
            datagram = self._socket.recv(_LARGEST_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as exc:
            self._inbox.end(self._refused(exc))
            return
        # An empty datagram says nothing, and a chunk has at least one byte.
        if datagram and not self._inbox.put(datagram):
            self.lost_datagrams += 1

    def _require_open(self) -> socket.socket:
        if not self._socket:
            raise LinkError(str(self._inbox.ended or f"{self.endpoint}: the link is not open: connect first"))
        return self._socket

    def _refused(self, exc: OSError) -> LinkError:
        return LinkError(
            f"{self.endpoint}: a datagram was refused ({exc.strerror or exc}): check that the instrument is switched "
            "on and listens on this port"
        )
