"""A robot that moves while somebody feeds and is stopped at once when nobody does."""

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import replace
from typing import Any

from catseye.app.engine.devices import DeviceBuilder, Devices, WireRecorder
from catseye.app.engine.halt import HaltLimits, halt
from catseye.app.engine.waiting import cancel
from catseye.app.errors import SafetyError
from catseye.app.service.walk.feed import Feed, FeedLostError
from catseye.app.service.walk.walk import Walk, WalkedOverride
from catseye.drivers.roles.clock import Clock, SystemClock
from catseye.drivers.roles.device import Examination, Identity
from catseye.drivers.roles.pose import Pose, Range
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus


class FedRobot(Robot):
    """A robot controller that moves to one target after another, while somebody feeds.

    Args:
        feed: keeps it going.
        meet: called with who answers.
        clock: real time.
        limits: how long a halt may take.
        noted: called with what becomes of the speed override.
    """

    def __init__(
        self,
        robot: Robot,
        feed: Feed,
        meet: Callable[[Identity], None],
        clock: Clock,
        limits: HaltLimits,
        noted: Callable[[WalkedOverride], None] = lambda _override: None,
    ) -> None:
        self._robot = robot
        self._feed = feed
        self._meet = meet
        self._clock = clock
        self._limits = limits
        self._noted = noted
        self._before_percent: float | None = None

    @property
    def notes(self) -> tuple[str, ...]:
        """What the driver knows about its connection."""
        return self._robot.notes

    @property
    def abilities(self) -> RobotAbilities:
        """What the driver is able to do, but for motions over more than one target and for jogging."""
        return replace(self._robot.abilities, following="stops", jogs=False)

    @property
    def own_program(self) -> str | None:
        """Program of the driver that runs on the controller."""
        return self._robot.own_program

    @property
    def read_back_limit(self) -> float:
        """How far an axis may be read back from the target of a motion."""
        return self._robot.read_back_limit

    async def connect(self) -> Identity:
        """Open the link and check who answers."""
        identity = await self._robot.connect()
        self._meet(identity)
        return identity

    async def close(self) -> None:
        """Disconnect."""
        await self._robot.close()

    async def status(self) -> RobotStatus:
        """Return the controller's state."""
        return await self._robot.status()

    async def servo(self, *, on: bool) -> None:
        """Switch the drives."""
        await self._robot.servo(on=on)

    async def reset_alarm(self) -> None:
        """Reset the active alarm."""
        await self._robot.reset_alarm()

    async def rest(self) -> str:
        """Hold an arm that stands without switching its drives."""
        return await self._robot.rest()

    async def set_override(self, percent: float) -> float:
        """Set the speed override; return what the controller reads back."""
        if self._before_percent is None:
            self._before_percent = (await self._robot.status()).override_percent
        read_percent = await self._robot.set_override(percent)
        self._noted(WalkedOverride(self._before_percent, percent, read_percent))
        return read_percent

    async def joints(self) -> Pose:
        """Return the reported joint positions."""
        return await self._robot.joints()

    async def joint_limits(self) -> tuple[Range, ...] | None:
        """Return the controller's own limits of all axes."""
        return await self._robot.joint_limits()

    async def examine(self) -> Examination:
        """Ask the controller what its maker provides beyond the role."""
        return await self._robot.examine()

    async def stop(self) -> None:
        """Stop now."""
        await self._robot.stop()

    async def torques(self) -> tuple[float, ...]:
        """Return the torques of the motors, N m."""
        return await self._robot.torques()

    async def move_joints(self, target: Pose) -> None:
        """Move while fed; see `_while_fed` for the errors."""
        await self._while_fed(lambda: self._robot.move_joints(target))

    async def step_to(self, target: Pose) -> None:
        """Step to a pose while fed; see `_while_fed` for the errors."""
        await self._while_fed(lambda: self._robot.step_to(target))

    async def step_axis(self, axis: str, increment: float) -> None:
        """Step one axis while fed; see `_while_fed` for the errors."""
        await self._while_fed(lambda: self._robot.step_axis(axis, increment))

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        """Step along a line while fed; see `_while_fed` for the errors."""
        await self._while_fed(lambda: self._robot.step_line(increment_mm))

    async def _while_fed(self, begin: Callable[[], Coroutine[Any, Any, None]]) -> None:
        """Carry out a motion while somebody feeds.

        Raises:
            FeedLostError: nobody feeds; the arm stands.
            SafetyError: nobody feeds, and the arm was not seen to stand.
        """
        if not self._feed.fed:
            raise FeedLostError("nobody keeps the walk going")
        motion = asyncio.create_task(begin())
        lost = asyncio.create_task(self._feed.lost())
        try:
            await asyncio.wait({motion, lost}, return_when=asyncio.FIRST_COMPLETED)
            if motion.done():
                return motion.result()
            report = await halt(self._robot, self._clock, self._limits, lambda: _drop(motion))
        finally:
            await cancel(motion, lost)
        if not report.standstill:
            raise SafetyError(f"PRESS THE EMERGENCY STOP: the walk was let go and {report.text}")
        raise FeedLostError("the key was let go: the arm was stopped")


def fed(build: DeviceBuilder, walk: Walk) -> DeviceBuilder:
    """Return a builder of the same devices whose robot moves while somebody feeds the walk."""

    def build_fed(record: WireRecorder) -> Devices:
        devices = build(record)
        # Whoever holds the key lives in real time, however fast the bench's own goes.
        robot = FedRobot(devices.robot, walk.feed, walk.meet, SystemClock(), HaltLimits(), walk.note_override)
        return replace(devices, robot=robot)

    return build_fed


def _drop(motion: "asyncio.Task[None]") -> None:
    motion.cancel()
