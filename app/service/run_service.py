"""The service of a run that is hosted by the command that started it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from app.engine.handle import RunHandle
from app.engine.waiting import uncancelled
from app.service.hub import Hub, Policy
from app.service.server import Server
from drivers.clock import SystemClock


class RunService:
    """Serves one run.

    Args:
        policy: what becomes of the run when a client with control is lost.
        console: the person at the terminal of this process; None without one.

    Attributes:
        hub: of its clients.
    """

    def __init__(self, policy: Policy, console: str | None) -> None:
        clock = SystemClock()
        self.hub = Hub(clock)
        self.hub.policy = policy
        self.hub.console = console
        self._server = Server(self.hub, clock)

    @asynccontextmanager
    async def serve(self, handle: RunHandle) -> AsyncIterator[None]:
        """Serve a run while its record is open; its clients hear of its end."""
        try:
            async with self._server.of_run(handle):
                yield
        finally:
            await uncancelled(self._server.end())
