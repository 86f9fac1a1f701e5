"""The service of a run that is hosted by the command that started it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from catseye.app.engine.handle import RunHandle
from catseye.app.engine.waiting import uncancelled
from catseye.app.protocol.loss import LossPolicy
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.server import Server
from catseye.app.service.watching.telemetry import Telemetry
from catseye.drivers.roles.clock import SystemClock


class RunService:
    """Serves one run.

    Args:
        policy: what becomes of the run when a client with control is lost.
        console: the person at the terminal of this process; None without one.

    Attributes:
        registry: of its clients.
        telemetry: of the bench.
    """

    def __init__(self, policy: LossPolicy, console: str | None, root: Path) -> None:
        clock = SystemClock()
        self.registry = ClientRegistry(clock)
        self.registry.policy = policy
        self.registry.lease.console = console
        self.telemetry = Telemetry(self.registry, clock, root)
        self._server = Server(self.registry, clock, telemetry=self.telemetry)

    @asynccontextmanager
    async def serve(self, handle: RunHandle) -> AsyncIterator[None]:
        """Serve a run while its record is open; its clients hear of its end."""
        try:
            async with self._server.of_run(handle):
                yield
        finally:
            await uncancelled(self.telemetry.end())
            await uncancelled(self._server.end())
