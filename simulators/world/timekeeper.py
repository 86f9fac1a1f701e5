"""Bench time from wall time: the bench advances when somebody asks, and exactly when somebody waits.

Physics takes real time. Where it takes more than there is, the bench falls behind its speed: nothing is left out,
bench time passes more slowly, and `behind_s` says by how much. No stretch of calculation keeps requests, timers and
signals waiting for long.

A process that does not run, on a loaded machine, reads nothing, where a real controller goes on reading. As long as a
controller watches for something that has to come in time (`stay_awake`), the bench stands still meanwhile.
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

_AWAKE_S = 0.02
"""Between two looks at the time as long as something has to come from outside, real s."""

_ASLEEP_S = 0.1
"""Between two looks at the time: for longer, this process did not run. Real s."""


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
        self._needed: Callable[[], bool] | None = None
        self._awake_s = 0.0

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

    def stay_awake(self, needed: Callable[[], bool]) -> None:
        """Look at the time again and again, as long as something has to come from outside in time: signs of life.

        Where nobody is served, since no event loop runs, whoever sets the time is responsible.

        Args:
            needed: whether it still is.
        """
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:
            return
        asleep, self._needed = self._needed is None, needed
        if asleep:
            self._awake_s = self._clock()
            loop.call_later(_AWAKE_S, self._stay_awake, loop)

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

    def _stay_awake(self, loop: asyncio.AbstractEventLoop) -> None:
        self.sync()
        if self._needed is not None and self._needed():
            loop.call_later(_AWAKE_S, self._stay_awake, loop)
        else:
            self._needed = None

    def _now_s(self) -> float:
        now_s = self._clock()
        slept_s, self._awake_s = now_s - self._awake_s, now_s
        wall_s, bench_s = self._anchor
        if self._needed is not None and slept_s > _ASLEEP_S:
            self._anchor = wall_s, bench_s = wall_s + slept_s, bench_s
            self._fall_behind(slept_s * self._speed)
            self.changed()
        return bench_s + (now_s - wall_s) * self._speed

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
            self._fall_behind(late_s)

    def _fall_behind(self, late_s: float) -> None:
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
