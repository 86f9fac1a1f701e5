"""Bench time from wall time: the bench advances when somebody asks, and exactly when somebody waits."""

import asyncio
import time
from collections.abc import Callable

from simulators.bench.bench import Bench


class TimeKeeper:
    """Maps wall time to bench time and wakes those who wait for a moment of bench time.

    Args:
        bench: the bench that is advanced.
        speed: bench seconds in one real second.
        clock: monotonic wall time, s.
    """

    def __init__(self, bench: Bench, speed: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        self.bench = bench
        self._speed = speed
        self._clock = clock
        self._anchor = (clock(), bench.time_s)
        self._waiters: set[asyncio.Future[None]] = set()

    @property
    def speed(self) -> float:
        """Bench seconds in one real second."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self.sync()
        self._anchor = (self._clock(), self.bench.time_s)
        self._speed = speed
        self.changed()

    def sync(self) -> float:
        """Advance the bench to this moment; return the bench time, s."""
        wall_s, bench_s = self._anchor
        self.bench.advance_to(bench_s + (self._clock() - wall_s) * self._speed)
        return self.bench.time_s

    def changed(self) -> None:
        """Let everybody who waits look again: what they wait for may come at another moment."""
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)

    async def wait(self, due: Callable[[], float | None]) -> None:
        """Wait for a moment of bench time that may change while waiting.

        Args:
            due: returns the bench time to wait for, or None when there is nothing left to wait for. It is asked
                again at that time and after each call of `changed`.
        """
        self.sync()
        while (due_s := due()) is not None:
            if await self._elapses(due_s):
                # The timer may fire a hair early; what ends at this moment has ended.
                self.bench.advance_to(due_s)
            else:
                self.sync()

    async def _elapses(self, due_s: float) -> bool:
        """Return True when the moment has come, False when something changed before."""
        wall_s, bench_s = self._anchor
        delay_s = wall_s + (due_s - bench_s) / self._speed - self._clock()
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.add(waiter)
        try:
            async with asyncio.timeout(max(0.0, delay_s)):
                await waiter
        except TimeoutError:
            return True
        finally:
            self._waiters.discard(waiter)
        return False
