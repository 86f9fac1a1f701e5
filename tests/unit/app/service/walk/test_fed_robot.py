"""A robot that moves while somebody feeds."""

import asyncio

import pytest

from catseye.app.engine.halt import HaltLimits
from catseye.app.errors import SafetyError
from catseye.app.service.walk.fed_robot import FedRobot
from catseye.app.service.walk.feed import FED_FOR_S, Feed, FeedLostError
from catseye.drivers.roles.pose import Pose
from tests.unit.app.engine.fakes import AWAY, HOME, FakeRobot, ManualClock

LIMITS = HaltLimits(standstill_s=0.5)


class Rig:
    """A robot that arrives when it is let, on a clock that passes as it is slept on."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.feed = Feed(self.clock)
        self.arm = FakeRobot(self.clock)
        self.robot = FedRobot(self.arm, self.feed, lambda _arm: None, self.clock, LIMITS)


async def test_a_motion_that_is_fed_arrives() -> None:
    rig = Rig()
    rig.feed.feed()
    await rig.robot.move_joints(AWAY)
    assert rig.arm.calls == ["move"]
    assert rig.arm.pose == AWAY


async def test_nothing_begins_unfed() -> None:
    rig = Rig()
    with pytest.raises(FeedLostError):
        await rig.robot.move_joints(AWAY)
    assert rig.arm.calls == []


async def test_the_arm_is_stopped_when_the_feed_ends() -> None:
    rig = Rig()
    rig.arm.blocks = True
    rig.feed.feed()
    with pytest.raises(FeedLostError, match="was stopped"):
        await rig.robot.move_joints(AWAY)
    # STOP goes out before the command is dropped.
    assert rig.arm.calls == ["move", "stop", "move cancelled"]
    assert rig.arm.pose == HOME
    assert FED_FOR_S <= rig.clock.time_s <= FED_FOR_S + 0.5


async def test_feeding_again_keeps_the_arm_going() -> None:
    rig = Rig()
    rig.arm.blocks = True
    rig.feed.feed()
    motion = asyncio.create_task(rig.robot.move_joints(AWAY))
    while rig.clock.time_s < 10 * FED_FOR_S:
        rig.feed.feed()
        await asyncio.sleep(0)
    assert rig.arm.calls == ["move"]
    with pytest.raises(FeedLostError):
        await motion
    assert rig.arm.calls[1] == "stop"


async def test_letting_go_stops_without_waiting_for_the_time() -> None:
    rig = Rig()
    rig.arm.blocks = True
    rig.feed.feed()
    motion = asyncio.create_task(rig.robot.move_joints(AWAY))
    await rig.arm.moving.wait()
    rig.feed.let_go()
    before_s = rig.clock.time_s
    with pytest.raises(FeedLostError):
        await motion
    # What is left is one look at the key and two at the arm.
    assert rig.clock.time_s - before_s <= 0.02 + 3 * LIMITS.poll_s
    assert rig.arm.calls == ["move", "stop", "move cancelled"]


async def test_an_arm_that_does_not_stand_is_an_alarm() -> None:
    rig = Rig()
    rig.arm.blocks = rig.arm.ignores_stop = rig.arm.creeps = True
    rig.feed.feed()
    with pytest.raises(SafetyError, match="PRESS THE EMERGENCY STOP"):
        await rig.robot.move_joints(AWAY)


async def test_a_cancelled_motion_leaves_nothing_behind() -> None:
    rig = Rig()
    rig.arm.blocks = True
    rig.feed.feed()
    motion = asyncio.create_task(rig.robot.move_joints(AWAY))
    await rig.arm.moving.wait()
    motion.cancel()
    with pytest.raises(asyncio.CancelledError):
        await motion
    assert rig.arm.calls == ["move", "move cancelled"]


async def test_emulated_devices_are_walked_by_themselves() -> None:
    rig = Rig()
    rig.feed.by_itself = True
    await rig.robot.move_joints(AWAY)
    assert rig.arm.pose == AWAY


class SteppingRobot(FakeRobot):
    """Is asked for steps and takes them as motions."""

    async def step_to(self, target: Pose) -> None:
        self.calls.append("step to")
        await self.move_joints(target)

    async def step_axis(self, axis: str, increment: float) -> None:
        assert (axis, increment) == ("A1", 0.1)
        await self.move_joints(AWAY)

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        assert increment_mm == (0.0, 1.0, 0.0)
        await self.move_joints(AWAY)


async def test_steps_that_are_fed_are_taken() -> None:
    rig = Rig()
    rig.arm = SteppingRobot(rig.clock)
    robot = FedRobot(rig.arm, rig.feed, lambda _arm: None, rig.clock, LIMITS)
    rig.feed.feed()
    await robot.step_axis("A1", 0.1)
    rig.feed.feed()
    await robot.step_line((0.0, 1.0, 0.0))
    rig.feed.feed()
    await robot.step_to(AWAY)
    assert rig.arm.calls == ["move", "move", "step to", "move"]


async def test_a_step_ends_with_the_feed() -> None:
    rig = Rig()
    rig.arm = SteppingRobot(rig.clock, blocks=True)
    robot = FedRobot(rig.arm, rig.feed, lambda _arm: None, rig.clock, LIMITS)
    rig.feed.feed()
    with pytest.raises(FeedLostError):
        await robot.step_axis("A1", 0.1)
    assert rig.arm.calls == ["move", "stop", "move cancelled"]
