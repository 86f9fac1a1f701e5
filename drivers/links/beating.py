"""What is said again and again while something goes on, such as a sign of life."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress

from catseye.drivers.roles.errors import DeviceError

Beat = Callable[[], Awaitable[None]]
"""Says it once, on a connection that nothing else waits on."""


@asynccontextmanager
async def beating(beats: Sequence[Beat], period_s: float, *, at_once: bool = True) -> AsyncIterator[None]:
    """Do something again and again until the context is left.

    One that fails is tried again: what counts is what arrives. One that still waits for its answer does not put the
    next one off as long as another connection is free.

    Args:
        beats: say it, each on a connection of its own; they take turns.
        period_s: from the beginning of one to that of the next, real s.
        at_once: the first is due at once; otherwise after a period.
    """
    pulse = _Pulse(period_s, at_once=at_once)
    tasks = [asyncio.create_task(_beat(beat, pulse)) for beat in beats]
    try:
        yield
    finally:
        pulse.ended.set()
        # The last exchanges are finished, so that the connections stay in step.
        await asyncio.gather(*tasks)


class _Pulse:
    """When the next one is due."""

    def __init__(self, period_s: float, *, at_once: bool) -> None:
        self.ended = asyncio.Event()
        self._period_s = period_s
        self._turn = asyncio.Lock()
        self._time_s = asyncio.get_running_loop().time
        self._next_s = self._time_s() + (0.0 if at_once else period_s)

    async def next(self) -> None:
        """Wait until the next one is due, or all is over; who comes first has the first turn."""
        async with self._turn:
            with suppress(TimeoutError):
                async with asyncio.timeout_at(self._next_s):
                    await self.ended.wait()
            self._next_s = self._time_s() + self._period_s


async def _beat(beat: Beat, pulse: _Pulse) -> None:
    await pulse.next()
    while not pulse.ended.is_set():
        with suppress(DeviceError):
            await beat()
        await pulse.next()
