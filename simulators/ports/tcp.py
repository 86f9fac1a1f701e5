"""A listening socket; each connection is a client.

asyncio switches Nagle's algorithm off on every TCP socket, so an answer leaves at once.
"""

import asyncio
from collections.abc import Callable

from catseye.simulators.ports.address import SocketAddress
from catseye.simulators.ports.conversation import Conversation, Wire

_MOST_BYTES = 1 << 20

_TURNS_TO_JOIN = 4
"""Turns of the event loop between accepting a connection and serving it; asyncio takes three."""


class TcpListener:
    """Takes connections.

    Args:
        most_clients: more at once are dropped; None takes any number.
    """

    def __init__(
        self,
        address: SocketAddress,
        converse: Callable[[Wire], Conversation],
        most_clients: int | None = None,
    ) -> None:
        self.converse = converse
        self.closing = False
        self.connections: set[Connection] = set()
        self._address = address
        self._most_clients = most_clients
        self._port = address.port
        self._server: asyncio.Server | None = None

    @property
    def endpoint(self) -> str:
        """Where clients find it."""
        return self._address.bound(self._port)

    async def open(self) -> None:
        """Listen.

        Raises:
            OSError: the address is in use or not of this computer.
        """
        loop = asyncio.get_running_loop()
        address = self._address
        self._server = await loop.create_server(lambda: Connection(self), address.host, address.port)
        self._port = self._server.sockets[0].getsockname()[1]

    @property
    def full(self) -> bool:
        """Whether there are more clients than are served at once."""
        return self._most_clients is not None and len(self.connections) > self._most_clients

    def drop(self) -> None:
        """Close all connections; new ones are welcome."""
        for connection in list(self.connections):
            connection.abort()

    async def close(self) -> None:
        """Stop listening and drop every client."""
        self.closing = True
        if self._server is None:
            return
        await close_server(self._server)
        gone = [connection.conversation.gone for connection in self.connections]
        self.drop()
        if gone:
            await asyncio.wait(gone)
        await self._server.wait_closed()
        self._server = None


class Connection(asyncio.Protocol):
    """One client."""

    gap_s = 0.0
    """A segment comes as a whole."""

    def __init__(self, listener: TcpListener) -> None:
        self._listener = listener
        self._transport: asyncio.Transport | None = None
        self.conversation = listener.converse(self)
        listener.connections.add(self)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take the client in."""
        if isinstance(transport, asyncio.Transport):
            self._transport = transport
        if self._listener.closing or self._listener.full or self.conversation.is_off:
            self.abort()

    def data_received(self, data: bytes) -> None:
        """Hand over what came."""
        self.conversation.feed(data)

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002  # asyncio's signature
        """End the conversation."""
        self._transport = None
        self._listener.connections.discard(self)
        self.conversation.end()

    def abort(self) -> None:
        """Drop the client."""
        if self._transport is not None:
            self._transport.abort()

    def send(self, data: bytes) -> None:
        """Send to the client; one that takes nothing while much is waiting for it is dropped."""
        if self._transport is None:
            return
        if self._transport.get_write_buffer_size() > _MOST_BYTES:
            self._transport.abort()
        else:
            self._transport.write(data)

    def hang_up(self) -> None:
        """End the connection behind what was sent."""
        if self._transport is not None:
            self._transport.close()

    def pause(self) -> None:
        """Leave what the client sends in the socket."""
        if self._transport is not None:
            self._transport.pause_reading()

    def resume(self) -> None:
        """Go on taking."""
        if self._transport is not None:
            self._transport.resume_reading()


async def close_server(server: asyncio.Server) -> None:
    """Accept nobody more, let those who were accepted be served, then close.

    A connection that is accepted in the very turn in which its server closes is neither served nor closed by asyncio:
    its socket stays open until the garbage collector finds it.
    """
    loop = asyncio.get_running_loop()
    for listener in server.sockets:
        loop.remove_reader(listener.fileno())
    for _ in range(_TURNS_TO_JOIN):
        await asyncio.sleep(0)
    server.close()
