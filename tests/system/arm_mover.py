"""A program that moves a robot until it is killed. Arguments: its make, its endpoint, and `guarded` or `alone`."""

import asyncio
import sys
from pathlib import Path

from catseye.app.guard.client import ArmGuard
from catseye.drivers.roles.clock import SystemClock
from tests.system.makes import MAKES, Make


async def move(make: Make, endpoint: str, *, guarded: bool) -> None:
    """Become the owner if guarded, and move slowly."""
    guard = ArmGuard(endpoint) if guarded else None
    robot = make.driver.at(endpoint, SystemClock(), guard=guard)
    await robot.connect()
    if guard is not None:
        await guard.hold("a test", Path(), simulated=True)
    await robot.set_override(2)
    await robot.move_joints((100.0, *make.pose[1:]))


if __name__ == "__main__":
    asyncio.run(move(MAKES[sys.argv[1]], sys.argv[2], guarded=sys.argv[3] == "guarded"))
