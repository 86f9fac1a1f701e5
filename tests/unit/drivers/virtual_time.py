"""An event loop whose clock jumps to the next timer: time-outs cost nothing, and a wait for ever is an error."""

import asyncio
import selectors
from collections.abc import Coroutine
from datetime import UTC, datetime
from typing import Any, TypeVar

T = TypeVar("T")


class WaitsForEverError(AssertionError):
    """Nothing is scheduled and nothing can come: the program would hang."""


class _Selector(selectors.SelectSelector):
    """Waits for no file; moves the clock instead."""

    now_s = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0)
        if not ready:
            if timeout is None:
                raise WaitsForEverError
            self.now_s += timeout
        return ready


class _Loop(asyncio.SelectorEventLoop):
    def __init__(self) -> None:
        self._clock = _Selector()
        super().__init__(self._clock)

    def time(self) -> float:
        return self._clock.now_s


class VirtualClock:
    """The clock of the running loop, for drivers."""

    def monotonic_s(self) -> float:
        return asyncio.get_running_loop().time()

    def now_utc(self) -> datetime:
        return datetime(2026, 1, 2, tzinfo=UTC)

    async def sleep(self, duration_s: float) -> None:
        await asyncio.sleep(duration_s)


def run(work: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end on a loop of its own."""
    with runner() as fresh:
        return fresh.run(work)


def runner() -> asyncio.Runner:
    """Return what runs several coroutines, one after the other, on one such loop."""
    return asyncio.Runner(loop_factory=_Loop)
