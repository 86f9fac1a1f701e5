"""The clock that drivers and the engine are given; nothing reads the time in any other way."""

import asyncio
import time
from datetime import UTC, datetime
from typing import Protocol


class Clock(Protocol):
    """Monotonic time, wall time and sleep."""

    def monotonic_s(self) -> float:
        """Return seconds since an arbitrary origin; never goes back."""
        ...

    def now_utc(self) -> datetime:
        """Return the wall time, UTC."""
        ...

    async def sleep(self, duration_s: float) -> None:
        """Wait for a duration in seconds of this clock."""
        ...


_TIMER_STEP_S = 0.0012
"""Timers of the event loop wake up to a millisecond late; the last stretch is waited for without one."""


class SystemClock:
    """Real time, or bench time that runs faster by a factor.

    Args:
        speed: seconds of this clock in one real second; 1 is real time.
    """

    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed

    def monotonic_s(self) -> float:
        """Return bench seconds."""
        return time.monotonic() * self.speed

    def now_utc(self) -> datetime:
        """Return the wall time, UTC, never scaled."""
        return datetime.now(UTC)

    async def sleep(self, duration_s: float) -> None:
        """Wait for bench seconds, to a few microseconds of real time."""
        loop = asyncio.get_running_loop()
        end_s = loop.time() + duration_s / self.speed
        await asyncio.sleep(max(0.0, end_s - loop.time() - _TIMER_STEP_S))
        while loop.time() < end_s:  # noqa: ASYNC110  # a timer is too coarse here
            await asyncio.sleep(0)
