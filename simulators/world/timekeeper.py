"""Bench time from wall time: the bench advances when somebody asks, and exactly when somebody waits.

Physics takes real time. Where it takes more than there is, the bench falls behind its speed: nothing is left out,
bench time passes more slowly, and `behind_s` says by how much. No stretch of calculation keeps requests, timers and
signals waiting for long.
"""

import asyncio
import time
from collections.abc import Callable

from catseye.simulators.world.timed_bench import TimedBench

_TIMER_STEP_S = 0.002
"""Timers of the event loop wake up to a millisecond late; the last stretch is waited for without one."""

_STRETCH_S = 0.02
"""Real time of calculation after which others have their turn."""

_PART_S = 0.01
"""Real time of a part of a stretch, about: how much bench time that is, is learnt from the parts before.

It is never less than what passes in so much real time: every part costs something of its own.
"""

_MOST_LATE_S = 0.25
"""Real time by which the bench may be late and still catch up, as after a pause of the whole machine."""

_LONGEST_PART_S = 3600.0


class TimeKeeper:
    """Maps wall time to bench time and wakes those who wait for a moment of bench time.

    Args:
        speed: bench seconds in one real second.
        clock: monotonic wall time, s.

    Attributes:
        behind_s: bench time by which the bench has fallen behind its speed so far, s.
        on_behind: called with it whenever it grows.
    """

    def __init__(
        self, bench: TimedBench, speed: float = 1.0, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.bench = bench
        self.behind_s = 0.0
        self.on_behind: Callable[[float], None] = lambda _behind_s: None
        self._speed = speed
        self._clock = clock
        self._anchor = (clock(), bench.time_s)
        self._part_s = _PART_S * speed
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
        """Advance the bench towards this moment, as far as there is time; return the bench time, s."""
        self._advance_to(self._now_s())
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
                self._advance_to(due_s)
            else:
                self.sync()

    def _now_s(self) -> float:
        wall_s, bench_s = self._anchor
        return bench_s + (self._clock() - wall_s) * self._speed

    def _advance_to(self, time_s: float) -> None:
        """Advance the bench to a moment, or as far towards it as a stretch of calculation leads."""
        began_s = now_s = self._clock()
        while True:
            self.bench.advance_to(min(time_s, self.bench.time_s + self._part_s))
            part_began_s, now_s = now_s, self._clock()
            self._learn(now_s - part_began_s)
            if self.bench.time_s >= time_s or now_s - began_s > _STRETCH_S:
                break
        late_s = self._now_s() - self.bench.time_s
        if late_s > _MOST_LATE_S * self._speed:
            self._anchor = (now_s, self.bench.time_s)
            self.behind_s += late_s
            self.on_behind(self.behind_s)

    def _learn(self, took_s: float) -> None:
        factor = min(2.0, max(0.5, _PART_S / took_s)) if took_s > 0.0 else 2.0
        self._part_s = max(_PART_S * self._speed, min(_LONGEST_PART_S, self._part_s * factor))

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
            self._advance_to(min(due_s, self._now_s()))
            while loop.time() < end_s and not waiter.done():  # noqa: ASYNC110  # a timer is too coarse here
                await asyncio.sleep(0)
        finally:
            self._waiters.discard(waiter)
        return not waiter.done()
