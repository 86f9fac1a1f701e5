"""A program that moves a KUKA until it is killed. Arguments: the proxy's endpoint, and `guarded` or `alone`."""

import asyncio
import sys
from pathlib import Path

from catseye.app.guard.client import ArmGuard
from catseye.drivers.kuka.robot import KukaVarproxy
from catseye.drivers.roles.clock import SystemClock

GOAL = (100.0, -90.0, 90.0, 0.0, 30.0, 0.0)


async def move(endpoint: str, *, guarded: bool) -> None:
    """Become the owner if guarded, and move slowly."""
    guard = ArmGuard(endpoint) if guarded else None
    robot = KukaVarproxy.at(endpoint, SystemClock(), guard=guard)
    await robot.connect()
    if guard is not None:
        await guard.hold("a test", Path(), simulated=True)
    await robot.set_override(2)
    await robot.move_joints(GOAL)


if __name__ == "__main__":
    asyncio.run(move(sys.argv[1], guarded=sys.argv[2] == "guarded"))
