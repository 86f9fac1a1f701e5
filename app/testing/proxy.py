"""What can happen to a TCP link, between a driver and whatever it talks to."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager

from catseye.app.testing.loop_thread import LoopThread
from catseye.app.testing.mishaps import Mishaps
from catseye.drivers.roles.device import Direction
from catseye.simulators.ports.tcp import close_server

_CHUNK_BYTES = 4096

_Say = Callable[[bytes, asyncio.StreamWriter], Awaitable[None]]
"""Hands bytes to one side of a connection."""


class Proxy:
    """Passes bytes on in both directions, and spoils the way back from the device on request.

    The attributes may be set from another thread; they hold for all connections.

    Args:
        device: host and port of the device; None for a device that takes everything and answers by `says`.
        says: what such a device answers to whatever comes.

    Attributes:
        stalled: what the device says is held back, and comes late when this is taken back.
        muted: what the device says is lost; what a stall has held back comes nevertheless.
        one_by_one: what the device says comes a byte at a time.
        flood: comes again and again beside what the device says, as fast as it is taken; empty: none.
        flooded_bytes: so much of it has been sent.
        spoil: what arrives of a piece that the device says; None changes nothing.
        opening: goes to the device at the beginning of each connection, before anything else.
        mishaps: what goes wrong at random with what clients say (tx) and with what the device says (rx), on
            connections that are opened from now on.
        heard: is called with what clients say, before anything goes wrong with it.
        connections: how many are open.
    """

    def __init__(self, device: tuple[str, int] | None, says: bytes = b"") -> None:
        self.stalled = False
        self.muted = False
        self.one_by_one = False
        self.flood = b""
        self.flooded_bytes = 0
        self.spoil: Callable[[bytes], bytes] | None = None
        self.opening = b""
        self.mishaps: dict[Direction, Mishaps] = {}
        self.heard: Callable[[bytes], None] | None = None
        self.connections = 0
        self.endpoint = ""
        self._device = device
        self._says = says
        self._writers: set[asyncio.StreamWriter] = set()
        self._to_clients: set[asyncio.StreamWriter] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._loop = asyncio.get_running_loop()

    def drop(self) -> None:
        """Reset all connections; may be called from another thread."""
        self._loop.call_soon_threadsafe(self._reset)

    def half_close(self) -> None:
        """Say no more to any client; what clients say is still passed on. May be called from another thread."""
        self._loop.call_soon_threadsafe(self._end_ways_back)

    def _end_ways_back(self) -> None:
        self.muted = True
        for writer in self._to_clients:
            with contextlib.suppress(OSError):
                writer.write_eof()

    @asynccontextmanager
    async def serving(self) -> AsyncIterator["Proxy"]:
        """Listen on a free port inside the context."""
        server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self.endpoint = f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}"
        try:
            yield self
        finally:
            await close_server(server)
            self._reset()
            for task in self._tasks:
                task.cancel()
            if self._tasks:
                await asyncio.wait(self._tasks)
            await server.wait_closed()

    def _reset(self) -> None:
        for writer in self._writers:
            writer.transport.abort()

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.get_running_loop().create_task(self._serve(reader, writer))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.connections += 1
        self._writers.add(writer)
        try:
            if self._device is None:
                await self._answer(reader, writer)
            else:
                await self._pass_on(self._device, reader, writer)
        except OSError:
            # Either side may be gone at any moment; both are closed below.
            return
        finally:
            self.connections -= 1
            self._writers.discard(writer)
            writer.transport.abort()

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while await reader.read(_CHUNK_BYTES):
            writer.write(self._says)

    async def _pass_on(
        self, device: tuple[str, int], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        from_device, to_device = await asyncio.open_connection(*device)
        self._writers.add(to_device)
        self._to_clients.add(writer)
        to_device.write(self.opening)
        try:
            ways = [
                asyncio.ensure_future(self._forth(reader, to_device)),
                asyncio.ensure_future(self._back(from_device, writer)),
                asyncio.ensure_future(self._gush(writer)),
            ]
            try:
                await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for way in ways:
                    way.cancel()
                await asyncio.gather(*ways, return_exceptions=True)
        finally:
            self._writers.discard(to_device)
            self._to_clients.discard(writer)
            to_device.transport.abort()

    async def _forth(self, reader: asyncio.StreamReader, to_device: asyncio.StreamWriter) -> None:
        way = self._way("tx", _hand_on)
        while data := await reader.read(_CHUNK_BYTES):
            if self.heard:
                self.heard(data)
            await way(data, to_device)

    async def _back(self, from_device: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        way = self._way("rx", self._say)
        while data := await from_device.read(_CHUNK_BYTES):
            held = self.stalled
            while self.stalled:  # noqa: ASYNC110  # the flag is set by another thread
                await asyncio.sleep(0.002)
            arrives = self.spoil(data) if self.spoil else data
            if arrives and (held or not self.muted):
                await way(arrives, writer)

    def _way(self, direction: Direction, say: _Say) -> _Say:
        """Return what takes the bytes of a new connection to the other side."""
        mishaps = self.mishaps.get(direction)
        if mishaps is None:
            return say
        way = mishaps.way()

        async def passed(data: bytes, writer: asyncio.StreamWriter) -> None:
            for piece in way.passed(data):
                await asyncio.sleep(piece.pause_s)
                if piece.data:
                    await say(piece.data, writer)
                if way.ended:
                    writer.write_eof()

        return passed

    async def _gush(self, writer: asyncio.StreamWriter) -> None:
        while True:
            flood = self.flood * (_CHUNK_BYTES // len(self.flood)) if self.flood else b""
            if flood:
                writer.write(flood)
                await writer.drain()
                self.flooded_bytes += len(flood)
            await asyncio.sleep(0 if flood else 0.002)

    async def _say(self, data: bytes, writer: asyncio.StreamWriter) -> None:
        size = 1 if self.one_by_one else len(data)
        for start in range(0, len(data), size):
            writer.write(data[start : start + size])
            await writer.drain()
            # Another turn of the loop, so that the pieces leave one by one.
            await asyncio.sleep(0)


class ProxyThread(LoopThread):
    """A thread in which proxies run."""

    @contextmanager
    def proxy(self, device: tuple[str, int] | None, says: bytes = b"") -> Iterator[Proxy]:
        """Run a proxy inside the context; see `Proxy` for the arguments."""
        proxy = self.run(_made(device, says))
        serving = proxy.serving()
        self.run(serving.__aenter__())
        try:
            yield proxy
        finally:
            self.run(serving.__aexit__(None, None, None))


async def _made(device: tuple[str, int] | None, says: bytes) -> Proxy:
    return Proxy(device, says)


async def _hand_on(data: bytes, writer: asyncio.StreamWriter) -> None:
    writer.write(data)
