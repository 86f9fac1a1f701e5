"""A datagram socket; each address that sends is a client, each datagram is fed as one piece.

Nobody says goodbye on UDP: a client is forgotten when many others have been heard since.
"""

import asyncio
from collections.abc import Callable
from typing import Any

from catseye.simulators.ports.address import SocketAddress
from catseye.simulators.ports.conversation import Conversation, Wire

MOST_PEERS = 32
"""How many clients are remembered; a newcomer takes the place of the one that was silent longest."""

Peer = tuple[Any, ...]
"""Address of a client, as the socket module has it."""


class UdpListener(asyncio.DatagramProtocol):
    """Takes datagrams."""

    def __init__(self, address: SocketAddress, converse: Callable[[Wire], Conversation]) -> None:
        self._converse = converse
        self._address = address
        self._port = address.port
        self._transport: asyncio.DatagramTransport | None = None
        self._clients: dict[Peer, _Client] = {}
        self._closed: asyncio.Future[None] | None = None

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
        self._closed = loop.create_future()
        local = (self._address.host, self._address.port)
        self._transport, _ = await loop.create_datagram_endpoint(lambda: self, local_addr=local)
        self._port = self._transport.get_extra_info("sockname")[1]

    def drop(self) -> None:
        """Forget all clients, with whatever their sessions knew."""
        for client in self._clients.values():
            client.conversation.end()
        self._clients.clear()

    async def close(self) -> None:
        """Forget all clients and stop listening."""
        gone = [client.conversation.gone for client in self._clients.values()]
        self.drop()
        if gone:
            await asyncio.wait(gone)
        if self._transport is not None and self._closed is not None:
            self._transport.close()
            await self._closed
        self._transport = None

    def datagram_received(self, data: bytes, addr: Peer) -> None:
        """Hand a datagram to its client's conversation."""
        client = self._clients.pop(addr, None) or self._newcomer(addr)
        self._clients[addr] = client
        client.take(data)

    def error_received(self, exc: Exception) -> None:
        """Take no note: a client that is gone is forgotten in time."""

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002  # asyncio's signature
        """Let `close` return."""
        if self._closed is not None and not self._closed.done():
            self._closed.set_result(None)

    def _newcomer(self, peer: Peer) -> "_Client":
        if len(self._clients) >= MOST_PEERS:
            longest_silent = next(iter(self._clients))
            self._clients.pop(longest_silent).conversation.end()
        return _Client(lambda data: self._send(peer, data), self._converse)

    def _send(self, peer: Peer, data: bytes) -> None:
        if self._transport is not None:
            self._transport.sendto(data, peer)


class _Client:
    """One address that sends."""

    gap_s = 0.0
    """A datagram comes as a whole."""

    def __init__(self, send: Callable[[bytes], None], converse: Callable[[Wire], Conversation]) -> None:
        self.send = send
        self._paused = False
        self.conversation = converse(self)

    def take(self, data: bytes) -> None:
        """Hand over a datagram; one that comes while the device is choked is lost, as on any UDP link."""
        if not self._paused:
            self.conversation.feed(data)

    def pause(self) -> None:
        """Lose what comes."""
        self._paused = True

    def resume(self) -> None:
        """Go on taking."""
        self._paused = False

    def hang_up(self) -> None:
        """Datagrams know no connection."""
