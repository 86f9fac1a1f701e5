"""The alarm of a cell's controller, seen and reset by a program that has no engine."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.cell.model import Cell
from catseye.app.engine.alarm import reset_read_alarm
from catseye.app.engine.instruments import device_builder, unrecorded
from catseye.app.errors import CatseyeError
from catseye.app.guard.lock import Owner, OwnerLock, arms_behind
from catseye.app.protocol.answers import Watching
from catseye.app.protocol.bench import BenchStatus
from catseye.app.protocol.engine_events import BenchSeen
from catseye.app.protocol.requests import Watch
from catseye.app.service.address import find_socket
from catseye.app.service.client import connect
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.robot import Robot

PROGRAM: Final = "alarm"

_LOOK_S: Final = 3.0
"""A look that is nobody's main business takes no longer, real s."""


@dataclass(frozen=True)
class Alarm:
    """What a controller says that is wrong.

    Attributes:
        number: 0 for none.
        text: what it means and what to do.
        resets: the driver can reset it; otherwise it is confirmed at the controller's pendant.
    """

    number: int
    text: str
    resets: bool


@dataclass(frozen=True)
class SeenController:
    """A controller that is connected, and the alarm that it was in.

    Attributes:
        robot: its driver.
        alarm: as it was seen.
    """

    robot: Robot
    alarm: Alarm

    async def reset(self) -> None:
        """Reset that alarm, and no other one.

        Raises:
            SafetyError: it is another one, or still there; the arm moves.
            DeviceError: the controller does not reset it.
        """
        await reset_read_alarm(self.robot, self.alarm.number, self.alarm.text)


@asynccontextmanager
async def seen_controller(cell: Cell) -> AsyncIterator[SeenController]:
    """Connect to the controller of a cell as the arm's only owner, and see its alarm.

    Raises:
        ArmInUseError: another program moves the arm.
        DeviceError: the controller does not answer.
        ConfigError: the driver cannot be made.
    """
    # Nobody waits for an owner here: who resets an alarm looks at an arm that nobody moves.
    lock = OwnerLock(await arms_behind(cell.robot.endpoint), Owner.here("its alarm is looked at"))
    try:
        robot = device_builder(cell, SystemClock())(unrecorded).robot
        try:
            await robot.connect()
            status = await robot.status()
            alarm = Alarm(status.alarm_number, status.alarm_text, robot.abilities.resets_alarms)
            yield SeenController(robot, alarm)
        finally:
            await robot.close()
    finally:
        # What a guard has left word of is for whoever moves the arm next.
        lock.undo()


async def alarm_if_seen(cell: Cell, root: Path) -> Alarm | None:
    """Return the alarm of a cell's controller; None where nobody can say soon.

    An engine of the folder of runs is asked; without one the controller itself, unless another program has the arm.
    """
    try:
        async with asyncio.timeout(_LOOK_S):
            path = find_socket(root)
            if path is not None:
                return await _alarm_at_engine(path, cell.name)
            async with seen_controller(cell) as seen:
                return seen.alarm
    except (CatseyeError, DeviceError, TimeoutError):
        return None


async def _alarm_at_engine(path: Path, cell: str) -> Alarm | None:
    async with connect(path, PROGRAM) as client:
        watching = await client.ask(Watch(op="watch"), Watching)
        if watching.bench is not None and watching.bench.robot is not None:
            return _alarm_of(watching.bench, cell)
        async for event in client.events():
            if isinstance(event, BenchSeen) and event.robot is not None:
                return _alarm_of(event, cell)
    return None


def _alarm_of(bench: BenchStatus, cell: str) -> Alarm | None:
    robot = bench.robot
    if robot is None or bench.cell != cell:
        return None
    return Alarm(robot.alarm_number, robot.alarm_text, robot.resets_alarms)
