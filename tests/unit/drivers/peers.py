"""Devices and clocks for the tests of this room: scripted, in memory, without real time."""

import asyncio
import contextlib
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterable
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from types import TracebackType
from typing import Any, Self, TypeVar

from catseye.app.testing.memory import MemoryTransport, pipe
from catseye.drivers.roles.errors import LinkError

T = TypeVar("T")

Answer = Callable[[bytes], Iterable[bytes]]


Serve = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


@asynccontextmanager
async def loopback(serve: Serve) -> AsyncIterator[int]:
    """Listen on a free port of the loopback; at the end every connection is closed."""
    connections: list[asyncio.Task[None]] = []

    async def handle(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            await serve(reader, writer)
        finally:
            writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()

    def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        connections.append(asyncio.create_task(handle(reader, writer)))

    listener = await asyncio.start_server(accept, "127.0.0.1", 0)
    try:
        yield listener.sockets[0].getsockname()[1]
    except BaseException:
        # A test that has failed may have left its end open.
        for connection in connections:
            connection.cancel()
        await asyncio.gather(*connections, return_exceptions=True)
        raise
    finally:
        listener.close()
        await listener.wait_closed()
    await asyncio.gather(*connections)


class StepClock:
    """A clock that is moved by the sleeps only."""

    def __init__(self) -> None:
        self.time_s = 100.0

    def monotonic_s(self) -> float:
        return self.time_s

    def now_utc(self) -> datetime:
        return datetime(2026, 1, 2, tzinfo=UTC)

    async def sleep(self, duration_s: float) -> None:
        self.time_s += duration_s
        await asyncio.sleep(0)


class FarEnd(ABC):
    """Serves the far end of a pipe as long as the context lasts.

    Args:
        endpoint: name of the pipe.
    """

    def __init__(self, endpoint: str) -> None:
        self.near, self.far = pipe(endpoint)
        self._task: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        await self.far.open()
        self._task = asyncio.create_task(self._serve())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, exc: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._task:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        await self.near.close()

    @abstractmethod
    async def _serve(self) -> None:
        """Answer what comes, until cancelled."""


class Peer(FarEnd):
    """Plays the device at the far end of a pipe: each chunk that comes is answered by chunks.

    Args:
        answer: from a request to the chunks of its answer; none keeps silent.
        endpoint: name of the pipe.
        on_hang_up: is called when the client closes its end.
    """

    def __init__(
        self,
        answer: Answer,
        *,
        endpoint: str = "memory://device",
        on_hang_up: Callable[[], None] = lambda: None,
    ) -> None:
        super().__init__(endpoint)
        self.requests: list[bytes] = []
        self.hang_ups = 0
        self._answer = answer
        self._on_hang_up = on_hang_up

    @property
    def transport(self) -> MemoryTransport:
        """The client's end."""
        return self.near

    async def say(self, data: bytes) -> None:
        """Send bytes that nobody asked for."""
        await self.far.write(data)

    async def _serve(self) -> None:
        while True:
            try:
                data = await self.far.read()
            except LinkError:
                self.hang_ups += 1
                self._on_hang_up()
                await asyncio.sleep(0)
                continue
            self.requests.append(data)
            for chunk in self._answer(data):
                with contextlib.suppress(LinkError):
                    await self.far.write(chunk)


async def settled() -> None:
    """Let every task go as far as it can."""
    for _ in range(10):
        await asyncio.sleep(0)


async def asked(question: Coroutine[Any, Any, T], peer: Peer, said: bytes) -> T:
    """Ask the driver, then let the device say something; return the answer."""
    task = asyncio.create_task(question)
    await settled()
    await peer.say(said)
    return await task
