"""Relative motions: the gate clears their farthest end, they are sent once, and the arm stands where it says."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.host import run_procedure
from catseye.app.engine.request import RunOutcome
from catseye.app.errors import LimitError
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities
from catseye.procedures.kit.context import Context, Stepped
from catseye.procedures.kit.errors import PlanError, StepCutShortError
from catseye.procedures.kit.motion.steps import line_target
from catseye.procedures.kit.system import System
from tests.unit.app.engine.fakes import FakeBench, FakeRobot, Script
from tests.unit.app.engine.test_interlock import Block, GuardedBench
from tests.unit.procedures.six_axes import AXES, BENCH, REACH_MM, STRETCHED

SHORT_DEG = 0.003
"""What a step of the arm below falls short by."""


@dataclass
class SteppingRobot(FakeRobot):
    """Adds increments to where it really stands, and falls a little short of them."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities(steps=True)

    steps: list[tuple[str, float]] = field(default_factory=list)
    lines: list[tuple[float, float, float]] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)

    async def step_to(self, target: Pose) -> None:
        self.poses.append(target)
        await super().move_joints(target)

    async def step_axis(self, axis: str, increment: float) -> None:
        self.steps.append((axis, increment))
        number = int(axis[1:]) - 1
        short = increment - SHORT_DEG
        target = tuple(value + short * (k == number) for k, value in enumerate(self.pose))
        await super().move_joints(target)

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        self.lines.append(increment_mm)
        await super().move_joints(self.pose)

    async def torques(self) -> tuple[float, ...]:
        return (1.0, -2.0, 3.0, -4.0, 5.0, -6.0)


@dataclass
class RoundingRobot(FakeRobot):
    """Takes no increments; poses with three decimals."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities(command_resolution={"deg": 0.001})

    targets: list[Pose] = field(default_factory=list)

    async def move_joints(self, target: Pose) -> None:
        self.targets.append(target)
        await super().move_joints(target)


@pytest.fixture
def bench(tmp_path: Path) -> FakeBench:
    made = FakeBench(tmp_path)
    made.robot = SteppingRobot(made.clock, pose=STRETCHED)
    return made


async def run(bench: FakeBench, body: Script, **changes: object) -> RunOutcome:
    request = bench.request(body, driven=BENCH.arm, **changes)
    return await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)


def stepping(bench: FakeBench) -> SteppingRobot:
    assert isinstance(bench.robot, SteppingRobot)
    return bench.robot


async def test_a_step_is_cleared_beyond_its_end_and_sent_once(bench: FakeBench) -> None:
    asked: list[Sequence[Pose]] = []
    found: list[Stepped] = []

    def blocked(way: Sequence[Pose]) -> str | None:
        asked.append(way)
        return None

    async def body(ctx: Context) -> None:
        found.append(await ctx.step_axis("A2", -0.5))
        found.append(await ctx.step_axis("A2", -0.5))

    outcome = await run(bench, Script(body), blocked=blocked)
    assert outcome.status == "complete"
    assert stepping(bench).steps == [("A2", -0.5)] * 2
    assert [way[0][1] for way in asked] == pytest.approx([0.0, -0.5 - SHORT_DEG])
    assert [way[1][1] for way in asked] == pytest.approx([-0.6, -1.1 - SHORT_DEG])
    first, second = found
    assert (first.before, first.commanded) == (STRETCHED, -0.5)
    assert first.after == second.before == pytest.approx((0.0, -0.5 - SHORT_DEG, 0.0, 0.0, 0.0, 0.0))
    assert first.ended_s - first.sent_s == pytest.approx(1.0)


async def test_a_step_that_may_end_outside_the_limits_is_refused(bench: FakeBench) -> None:
    bench.robot.pose = (0.0, 109.5, 0.0, 0.0, 0.0, 0.0)
    outcome = await run(bench, Script(lambda ctx: stepped(ctx, "A2", 0.45)))
    # It would end 0.05 deg short of the limit, and the gate wants a tenth.
    assert "A2 = 110.05 deg is outside -110 … 110 deg" in outcome.text
    assert stepping(bench).steps == []


async def stepped(ctx: Context, axis: str, increment: float) -> None:
    await ctx.step_axis(axis, increment)


@pytest.mark.parametrize("increment", [1.01, -5.0, float("nan"), float("inf")])
async def test_a_large_step_is_refused(bench: FakeBench, increment: float) -> None:
    outcome = await run(bench, Script(lambda ctx: stepped(ctx, "A2", increment)))
    assert "a relative motion is at most 1°; drive to a pose instead" in outcome.text
    assert stepping(bench).steps == []


async def test_bodies_in_the_way_of_a_step_refuse_it(bench: FakeBench) -> None:
    outcome = await run(bench, Script(lambda ctx: stepped(ctx, "A2", 0.1)), blocked=lambda _way: "the post")
    assert outcome.text.startswith("the post; the robot was not moved")
    assert stepping(bench).steps == []


async def test_a_straight_step_is_cleared_to_where_its_joints_end(bench: FakeBench) -> None:
    asked: list[Sequence[Pose]] = []
    found: list[Stepped] = []

    def blocked(way: Sequence[Pose]) -> str | None:
        asked.append(way)
        return None

    async def body(ctx: Context) -> None:
        found.append(await ctx.step_line((0.0, -0.4, 0.0)))

    assert (await run(bench, Script(body), blocked=blocked)).status == "complete"
    assert stepping(bench).lines == [(0.0, -0.4, 0.0)]
    assert found[0].commanded == pytest.approx(0.4)
    # The scripted arm's first three axes are those of the base frame; a tenth of a millimetre is added.
    assert asked[0][1] == pytest.approx((0.0, -0.5, 0.0, 0.0, 0.0, 0.0))


async def test_a_step_to_a_pose_goes_as_steps_do(bench: FakeBench) -> None:
    target = (0.0, 0.1, 0.0, 0.0, 0.0, 0.0)

    async def body(ctx: Context) -> None:
        await ctx.step_to(target)

    assert (await run(bench, Script(body))).status == "complete"
    assert stepping(bench).poses == [target]


async def test_after_a_step_the_arm_is_where_it_says(bench: FakeBench) -> None:
    asked: list[Sequence[Pose]] = []

    def blocked(way: Sequence[Pose]) -> str | None:
        asked.append(way)
        return None

    async def body(ctx: Context) -> None:
        await ctx.step_axis("A1", 0.5)
        await ctx.move(STRETCHED)

    assert (await run(bench, Script(body), blocked=blocked)).status == "complete"
    assert asked[1][0][0] == pytest.approx(0.5 - SHORT_DEG)


async def test_a_driver_without_steps_is_sent_rounded_poses(bench: FakeBench) -> None:
    robot = RoundingRobot(bench.clock, pose=(0.0104, 0.0, 0.0, 0.0, 0.0, 0.0))
    bench.robot = robot
    found: list[Stepped] = []

    async def body(ctx: Context) -> None:
        found.append(await ctx.step_axis("A1", 0.0321))

    assert (await run(bench, Script(body))).status == "complete"
    assert robot.targets == [pytest.approx((0.042, 0.0, 0.0, 0.0, 0.0, 0.0))]
    assert found[0].commanded == pytest.approx(0.042 - 0.0104)


async def test_a_driver_without_lines_refuses_them(bench: FakeBench) -> None:
    bench.robot = FakeRobot(bench.clock, pose=STRETCHED)

    async def body(ctx: Context) -> None:
        with pytest.raises(RefusedError, match="steps along no line"):
            await ctx.step_line((0.1, 0.0, 0.0))

    assert (await run(bench, Script(body))).status == "complete"


async def test_torques_are_the_controllers(bench: FakeBench) -> None:
    found: list[tuple[float, ...]] = []

    async def body(ctx: Context) -> None:
        found.append(await ctx.torques())

    assert (await run(bench, Script(body))).status == "complete"
    assert found == [(1.0, -2.0, 3.0, -4.0, 5.0, -6.0)]


async def test_a_door_that_opens_cuts_a_step_short_for_good(tmp_path: Path) -> None:
    bench = GuardedBench(tmp_path)
    bench.block = Block()
    robot = SteppingRobot(bench.clock, pose=STRETCHED)
    bench.robot = robot
    robot.blocks = True

    caught: list[StepCutShortError] = []

    async def body(ctx: Context) -> None:
        try:
            await ctx.step_axis("A1", 0.1)
        except StepCutShortError as error:
            caught.append(error)
        robot.blocks = False
        await ctx.step_axis("A1", 0.2)

    running = asyncio.create_task(run(bench, Script(body)))
    await robot.moving.wait()
    bench.block.closed = False
    while "UNSUSPENDING" not in bench.states():  # noqa: ASYNC110  # the bench only keeps a list
        await asyncio.sleep(0)
    bench.block.closed = True
    outcome = await running
    assert outcome.status == "complete"
    assert "the step of A1 by +0.1° was cut short and is not completed" in str(caught[0])
    assert robot.steps == [("A1", 0.1), ("A1", 0.2)]
    assert "stop" in robot.calls


async def test_a_rehearsal_steps_and_clears_its_way() -> None:
    dry = DryRunContext(System(BENCH), STRETCHED)
    found = await dry.step_axis("A1", 0.5)
    assert (found.before, found.commanded, found.after) == (STRETCHED, 0.5, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert [leg.end[0] for leg in dry.motions] == [0.5]
    dry.pose = (AXES[0].high, 0.0, 0.0, 0.0, 0.0, 0.0)
    with pytest.raises(LimitError, match=r"A1 = 165\.1 deg is outside"):
        await dry.step_axis("A1", 0.1)


async def test_a_rehearsed_line_shifts_the_tool_alone() -> None:
    system = System(BENCH)
    start = (0.0, -20.0, 20.0, 0.0, 40.0, 0.0)
    dry = DryRunContext(system, start)
    await dry.step_line((0.6, 0.0, -0.8))
    before, after = system.bench.workspace.chain.frames(np.array([start, dry.pose]))[-1]
    assert after[:3, 3] - before[:3, 3] == pytest.approx([0.6, 0.0, -0.8], abs=1e-6)
    assert after[:3, :3] == pytest.approx(before[:3, :3], abs=1e-9)


def test_a_line_that_the_arm_cannot_make_is_refused() -> None:
    with pytest.raises(PlanError, match="cannot shift its tool by"):
        line_target(BENCH, STRETCHED, (REACH_MM, 0.0, 2000.0))
