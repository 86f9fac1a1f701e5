"""Bench time from wall time: the bench advances when somebody asks, and exactly when somebody waits."""

import asyncio
import time
from collections.abc import Callable

from catseye.simulators.world.timed_bench import TimedBench

_TIMER_STEP_S = 0.002
"""Timers of the event loop wake up to a millisecond late; the last stretch is waited for without one."""


class TimeKeeper:
    """Maps wall time to bench time and wakes those who wait for a moment of bench time.

    Args:
        speed: bench seconds in one real second.
        clock: monotonic wall time, s.
    """

    def __init__(
        self, bench: TimedBench, speed: float = 1.0, clock: Callable[[], float] = time.monotonic
    ) -> None:
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
        self.bench.advance_to(self._now_s())
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

    def _now_s(self) -> float:
        wall_s, bench_s = self._anchor
        return bench_s + (self._clock() - wall_s) * self._speed

    async def _elapses(self, due_s: float) -> bool:
        """Return True when the moment has come, False when something changed before."""
        wall_s, bench_s = self._anchor
        delay_s = wall_s + (due_s - bench_s) / self._speed - self._clock()
        loop = asyncio.get_running_loop()
        end_s = loop.time() + delay_s
        waiter: asyncio.Future[None] = loop.create_future()
        self._waiters.add(waiter)
        try:
            await asyncio.wait([waiter], timeout=max(0.0, delay_s - _TIMER_STEP_S))
            # The bulk of the motion is calculated while there is still time.
            self.bench.advance_to(min(due_s, self._now_s()))
            while loop.time() < end_s and not waiter.done():  # noqa: ASYNC110  # a timer is too coarse here
                await asyncio.sleep(0)
        finally:
            self._waiters.discard(waiter)
        return not waiter.done()
