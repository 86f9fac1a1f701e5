"""A program that heals the link that its guard holds, then moves for ever. Argument: the port that it connects to."""

import asyncio
import sys
from pathlib import Path

from app.guard.client import ArmGuard
from drivers.endpoint import open_transport
from drivers.guarding import GuardedTransport

STOP = b"\r1;1;STOP\r"


async def move(endpoint: str) -> None:
    """Connect, become the owner, connect anew, move."""
    guard = ArmGuard(endpoint)
    link = GuardedTransport(open_transport(endpoint), guard, "robot", STOP)
    await link.open()
    await guard.hold("a test", Path(), simulated=True)
    await link.close()
    await link.open()
    async with guard.motion():
        guard.permit()
        await link.write(b"moving")
        await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(move(f"tcp://127.0.0.1:{sys.argv[1]}"))
