"""A guard without process and lock, for tests that move virtual arms."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from catseye.app.errors import CatseyeError
from catseye.app.guard.client import ArmGuard
from catseye.drivers.links.guarding import GuardError


class FakeGuard(ArmGuard):
    """Notes what it is asked."""

    def __init__(self, endpoint: str = "memory://robot") -> None:
        super().__init__(endpoint)
        self.calls: list[str] = []
        self.history: list[str] = []
        self.refusal: CatseyeError | None = None
        self.stopped = ""

    async def hold(self, who: str, folder: Path, *, simulated: bool) -> list[str]:
        del folder, simulated
        self.calls.append(f"hold {who}")
        if self.refusal is not None:
            raise self.refusal
        return self.history

    async def let_go(self) -> None:
        self.calls.append("let go")

    def acknowledge(self) -> None:
        self.stopped = ""

    def protect(self, name: str, descriptor: int, stop: bytes) -> None:
        del descriptor
        self.calls.append(f"protect {name} {stop!r}")

    async def release(self, name: str) -> None:
        self.calls.append(f"release {name}")

    def permit(self) -> None:
        if self.stopped:
            raise GuardError(self.stopped)

    @asynccontextmanager
    async def motion(self) -> AsyncIterator[None]:
        self.permit()
        self.calls.append("motion")
        yield
        self.calls.append("still")

    def stops(self, reason: str) -> None:
        """Do as if the guard had stopped the arm."""
        self.stopped = reason
        self.on_stop(reason)
