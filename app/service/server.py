"""Listening for clients, and serving each of them in a task of its own."""

import asyncio
import logging
import socket
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from pathlib import Path
from typing import Final

from catseye.app.engine.handle import RunHandle
from catseye.app.engine.waiting import cancel
from catseye.app.protocol.message import MAX_LINE_BYTES
from catseye.app.service.address import listening
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import ServiceError
from catseye.app.service.request_handler import Engine, RequestHandler
from catseye.app.service.session import Patience, Session
from catseye.app.service.sparse_log import SparseLog
from catseye.app.service.watching.telemetry import Telemetry
from catseye.drivers.roles.clock import Clock

_log = logging.getLogger(__name__)

MOST_STRANGERS: Final = 32
"""Connections without hello at a time; one more takes the place of the oldest."""

_ACCEPT_AGAIN_S: Final = 1.0
"""After the system had no room for another connection."""


class Server:
    """Accepts clients at any number of sockets.

    Args:
        clock: real time.
        engine: that can start runs; None where a run serves itself.
        telemetry: of the bench; None where nobody can watch it.
    """

    def __init__(
        self,
        registry: ClientRegistry,
        clock: Clock,
        engine: Engine | None = None,
        patience: Patience | None = None,
        telemetry: Telemetry | None = None,
    ) -> None:
        self._registry = registry
        self._clock = clock
        self._handler = RequestHandler(registry, engine, telemetry)
        self._patience = patience or Patience()
        self._errors = SparseLog(_log, clock)
        self._sessions: dict[asyncio.Task[None], Session] = {}
        self._over = False

    @asynccontextmanager
    async def at(self, place: Path) -> AsyncIterator[None]:
        """Serve clients at the socket of a run's directory, or of a folder of runs.

        Raises:
            ServiceError: another engine listens there, or no socket can be made.
        """
        with listening(place) as listener:
            async with self.on(listener):
                yield

    @asynccontextmanager
    async def on(self, listener: socket.socket) -> AsyncIterator[None]:
        """Serve clients of a listening socket."""
        accepting = asyncio.create_task(self._accept_from(listener))
        try:
            yield
        finally:
            await cancel(accepting)
            listener.close()

    @asynccontextmanager
    async def of_run(self, handle: RunHandle) -> AsyncIterator[None]:
        """Serve a run while its record is open; without a socket it goes on alone, and says so."""
        async with AsyncExitStack() as stack:
            stack.enter_context(self._registry.running(handle))
            try:
                await stack.enter_async_context(self.at(handle.path))
            except ServiceError as error:
                handle.warn(f"nobody can attach to this run: {error}")
            yield

    def accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve a client from now on; one that comes after the end is let go."""
        if self._over:
            writer.transport.abort()
            return
        strangers = [session for session in self._sessions.values() if session.is_stranger]
        if len(strangers) >= MOST_STRANGERS:
            # Whoever comes now may want to stop the arm, which takes no hello.
            strangers[0].dismiss(f"{MOST_STRANGERS} newer connections wait without hello")
        session = Session(self._registry, self._handler, (reader, writer), self._clock, self._patience)
        task = asyncio.create_task(session.serve())
        self._sessions[task] = session
        task.add_done_callback(self._gone)

    async def end(self) -> None:
        """Let the last messages reach the clients, then let the clients go."""
        # A client that was accepted last has its session only after this turn of the loop.
        await asyncio.sleep(0)
        self._over = True
        await asyncio.gather(*(session.flush() for session in self._sessions.values()))
        await cancel(*self._sessions)

    async def _accept_from(self, listener: socket.socket) -> None:
        """Accept one client after another; between two of them those who are there are heard."""
        while True:
            try:
                connection = await _next_connection(listener)
                self.accept(*await asyncio.open_unix_connection(sock=connection, limit=MAX_LINE_BYTES))
            except OSError as error:
                self._errors.error("a client could not be accepted", error)
                await self._clock.sleep(_ACCEPT_AGAIN_S)

    def _gone(self, task: "asyncio.Task[None]") -> None:
        self._sessions.pop(task, None)
        if not task.cancelled() and (error := task.exception()) is not None:
            self._errors.error("a client's session failed", error)


async def _next_connection(listener: socket.socket) -> socket.socket:
    """Wait for a connection, then take it: one that `sock_accept` has taken is lost when it is cancelled then."""
    loop = asyncio.get_running_loop()
    while True:
        ready = asyncio.Event()
        loop.add_reader(listener, ready.set)
        try:
            await ready.wait()
        finally:
            loop.remove_reader(listener)
        with suppress(BlockingIOError):
            return listener.accept()[0]
