"""What is said again and again while something goes on, such as a sign of life."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

from catseye.drivers.roles.errors import DeviceError


@asynccontextmanager
async def beating(beat: Callable[[], Awaitable[None]], period_s: float) -> AsyncIterator[None]:
    """Do something at once and then again and again until the context is left.

    One that fails is tried again: what counts is what arrives.

    Args:
        beat: says it, on a connection that nothing else waits on.
        period_s: from the beginning of one to that of the next, real s.
    """
    ended = asyncio.Event()
    task = asyncio.create_task(_beat(beat, period_s, ended))
    try:
        yield
    finally:
        ended.set()
        # The last exchange is finished, so that the connection stays in step.
        await task


async def _beat(beat: Callable[[], Awaitable[None]], period_s: float, ended: asyncio.Event) -> None:
    time_s = asyncio.get_running_loop().time
    while not ended.is_set():
        next_s = time_s() + period_s
        with suppress(DeviceError):
            await beat()
        with suppress(TimeoutError):
            # An answer that takes its time does not put the next sign of life off.
            async with asyncio.timeout_at(next_s):
                await ended.wait()
