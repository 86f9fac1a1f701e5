"""The sign of life that the program on the controller waits for while it moves the arm."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from catseye.drivers.kuka import names
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.links.healing import Repeat
from catseye.drivers.roles.errors import DeviceError


@asynccontextmanager
async def heartbeat(proxy: Proxy, period_s: float) -> AsyncIterator[None]:
    """Write the sign of life again and again; the program stops the arm by itself 0.5 s after the last.

    A connection that does not get it through is healed and tried again: what counts is what arrives.

    Args:
        proxy: connection that nothing else waits on.
        period_s: between two signs, real s.
    """
    ended = asyncio.Event()
    beating = asyncio.create_task(_beat(proxy, period_s, ended))
    try:
        yield
    finally:
        ended.set()
        # The last exchange is finished, so that the connection stays in step.
        await beating


async def _beat(proxy: Proxy, period_s: float, ended: asyncio.Event) -> None:
    while not ended.is_set():
        with suppress(DeviceError):
            await proxy.write({names.BEAT: "TRUE"}, repeat=Repeat.NEVER)
        with suppress(TimeoutError):
            async with asyncio.timeout(period_s):
                await ended.wait()
