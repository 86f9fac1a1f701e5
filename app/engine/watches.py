"""Who looks at controller, air and door while a run is under way."""

import asyncio
from collections.abc import Callable, Sequence

from catseye.app.engine.conditions import Condition, Watchman
from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices
from catseye.app.engine.door_watch import DoorWatch
from catseye.app.engine.ending import DeviceFaultError
from catseye.app.engine.gate import MotionGate, require_ready
from catseye.app.engine.hold_limit import HoldLimit
from catseye.app.engine.waiting import cancel
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.robot import RobotStatus

POLL_S = 0.5
"""Real seconds between two looks at what is missing, or may be."""


class Watches:
    """The watches of a run, each a task of its own: none waits for another one.

    Args:
        speed: seconds of the clock in one real second.

    Attributes:
        door: None where the cell has no door that is watched.
    """

    def __init__(self, control: RunControl, devices: Devices, clock: Clock, speed: float) -> None:
        self.door = None if devices.io is None else DoorWatch(devices.io, clock, self._door_forbids, speed)
        self._control = control
        self._devices = devices
        self._clock = clock
        self._speed = speed
        self._tasks: list[asyncio.Task[None]] = []
        self._over = False

    async def watch_door(self) -> None:
        """From now on the door is looked at; it has been when this returns."""
        if self.door is not None:
            await self.door.look()
            self._begin(asyncio.create_task(self.door.watch()))

    def watch_controller(self, gate: MotionGate, conditions: Sequence[Condition]) -> None:
        """From now on the controller is looked at, and the air."""

        def ready(status: RobotStatus) -> None:
            require_ready(status)
            gate.require_override(status.override_percent)

        watchman = Watchman(
            self._control, self._devices.robot, conditions, ready, self._clock, POLL_S * self._speed
        )
        self._begin(asyncio.create_task(watchman.watch()))

    def watch_holds(self, attended: Callable[[], bool], limit_s: float) -> None:
        """From now on a run that nobody could let go on does not wait for ever; see `HoldLimit`."""
        limit = HoldLimit(self._control, self._clock, attended, limit_s, self._speed, POLL_S)
        self._begin(asyncio.create_task(limit.watch()))

    async def end(self) -> None:
        """Look no more."""
        self._over = True
        await cancel(*self._tasks)

    def _door_forbids(self, trouble: str) -> None:
        self._control.interrupt(trouble, anew=self.door is not None and self.door.just_opened)

    def _begin(self, task: "asyncio.Task[None]") -> None:
        self._tasks.append(task)
        task.add_done_callback(self._ended)

    def _ended(self, task: "asyncio.Task[None]") -> None:
        """Nothing goes on unwatched: a watch that ends before the run, by a fault of the program, ends the run."""
        error = None if task.cancelled() else task.exception()
        if not self._over or error is not None:
            self._control.fault(DeviceFaultError(error or RuntimeError("a watch has ended before its run")))
