"""A program that heals the link that its guard holds, then moves for ever.

Arguments: where it connects to, and `forked` for one that has a child which keeps open what it has itself.
"""

import asyncio
import os
import sys
import time
from pathlib import Path

from catseye.app.guard.client import ArmGuard
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import GuardedTransport

STOP = b"\r1;1;STOP\r"
CHILD_S = 5.0


async def move(endpoint: str) -> None:
    """Connect, become the owner, connect again, move."""
    guard = ArmGuard(endpoint)
    link = GuardedTransport(open_transport(endpoint), guard, "robot", STOP)
    await link.open()
    await guard.hold("a test", Path(), simulated=True)
    await link.close()
    await link.open()
    if sys.argv[2:] == ["forked"]:
        fork()
    async with guard.motion():
        guard.permit()
        await link.write(b"moving")
        await asyncio.Event().wait()


def fork() -> None:
    """Make a child that has everything open that this process has, and outlives it for a while."""
    if not os.fork():
        time.sleep(CHILD_S)
        os._exit(0)


if __name__ == "__main__":
    asyncio.run(move(sys.argv[1]))
