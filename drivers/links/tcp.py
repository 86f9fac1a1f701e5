"""The transport over a TCP socket.

The socket is read directly, without asyncio's streams: a question and its answer take fewer turns of the loop, and
what has come unasked is seen without any.
"""

import asyncio
import contextlib
import os
import socket

from catseye.drivers.links.channel import Channel, ChannelTransport
from catseye.drivers.links.transport import socket_endpoint
from catseye.drivers.roles.errors import LinkError

_ENDED = (
    "the other side has closed the connection: check the instrument, its power, and whether another program "
    "has connected to it"
)


class TcpTransport(ChannelTransport):
    """A client socket without Nagle's delay.

    Args:
        connect_timeout_s: how long connecting may take, s.
    """

    def __init__(self, host: str, port: int, *, connect_timeout_s: float = 5.0) -> None:
        super().__init__()
        self._host = host
        self._port = port
        self._connect_timeout_s = connect_timeout_s
        self._socket: socket.socket | None = None

    @property
    def endpoint(self) -> str:
        """Where it leads: tcp://host:port."""
        return socket_endpoint("tcp", self._host, self._port)

    async def open(self) -> None:
        """Connect; an open link is kept.

        Raises:
            LinkError: unreachable; the text names the endpoint and what to check.
        """
        if self._is_open():
            return
        await self.close()
        try:
            async with asyncio.timeout(self._connect_timeout_s):
                link = await self._connected()
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
        self._socket = link
        self._channel = Channel(link.fileno(), self.endpoint, ended=_ENDED, broken=_broken)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        self._let_go()
        link, self._socket = self._socket, None
        if link:
            # Somebody may hold a duplicate of the descriptor, which would keep the connection.
            with contextlib.suppress(OSError):
                link.shutdown(socket.SHUT_RDWR)
            link.close()

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


def _broken(exc: OSError) -> str:
    return f"the connection broke ({exc.strerror or exc}): check cable and power"
