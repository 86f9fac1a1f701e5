"""A run owns its arm before anything is sent to it, and ends when the guard has stopped it."""

import asyncio
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.errors import ArmInUseError
from catseye.app.exitcode import ExitCode
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Prompt
from tests.unit.app.engine.fakes import AWAY, FakeBench, FakeRobot, Script
from tests.unit.app.guard.fakes import FakeGuard


class GuardedBench(FakeBench):
    """A bench whose arm has a guard."""

    guard: FakeGuard

    def build(self, record: WireRecorder) -> Devices:
        devices = super().build(record)
        return Devices(devices.robot, devices.interferometer, devices.environment, guard=self.guard)


@dataclass
class GuardStopsFirst(FakeRobot):
    """Finds at its first motion, which it does not write, that the guard has stopped the arm."""

    guard: FakeGuard = field(default_factory=FakeGuard)
    asked: bool = False

    async def move_joints(self, target: Pose) -> None:
        if not self.asked:
            self.asked = True
            self.guard.stopped = "the guard stopped the arm"
            asyncio.get_running_loop().call_soon(self.guard.on_stop, self.guard.stopped)
        self.guard.permit()
        await super().move_joints(target)


@pytest.fixture
def bench(tmp_path: Path) -> GuardedBench:
    made = GuardedBench(tmp_path)
    made.guard = FakeGuard()
    return made


async def move(ctx: Context) -> None:
    await ctx.move(AWAY)


async def test_arm_of_another_program_is_neither_moved_nor_stopped(bench: GuardedBench) -> None:
    bench.guard.refusal = ArmInUseError("the arm is in use by process 7")
    outcome = await run_procedure(
        bench.request(Script(move)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.DEVICE)
    assert "process 7" in outcome.text
    assert bench.robot.calls == ["connect", "close"]


async def test_arm_is_owned_from_the_drives_to_the_last_connection(bench: GuardedBench) -> None:
    outcome = await run_procedure(
        bench.request(Script(move)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert outcome.status == "complete"
    assert bench.guard.calls == [f"hold run {outcome.path.name}", "let go"]
    assert bench.robot.calls[-1] == "close"


async def stopped_by_guard(ctx: Context, bench: GuardedBench) -> None:
    bench.guard.stops("the guard stopped the arm")
    await ctx.move(AWAY)


async def test_run_that_the_guard_stopped_ends_stopped_and_unacknowledged(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        await stopped_by_guard(ctx, bench)

    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.SAFETY)
    assert "catseye resume" in outcome.text
    assert outcome.unacknowledged == "the guard stopped the arm"
    assert "stop" in bench.robot.calls
    assert "move" not in bench.robot.calls


async def test_run_goes_on_once_a_person_acknowledges_the_guard(bench: GuardedBench) -> None:
    asked: list[Prompt] = []

    async def ada(prompt: Prompt) -> Answer:
        assert "move" not in bench.robot.calls
        assert bench.guard.stopped
        asked.append(prompt)
        return Answer("yes", "Ada")

    async def body(ctx: Context) -> None:
        await stopped_by_guard(ctx, bench)

    request = bench.request(Script(body), answerer=ada)
    outcome = await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    assert (outcome.status, outcome.unacknowledged) == ("complete", "")
    assert [(prompt.id, prompt.motion) for prompt in asked] == [("acknowledge/1", True)]
    assert "the guard stopped the arm" in asked[0].text
    assert bench.guard.stopped == ""
    assert bench.robot.calls.count("move") == 1


async def test_motion_that_the_guard_refuses_is_sent_after_the_acknowledgement(bench: GuardedBench) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        return Answer("yes", "Ada")

    bench.robot = GuardStopsFirst(bench.clock, guard=bench.guard)

    request = bench.request(Script(move), answerer=ada)
    outcome = await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    assert outcome.status == "complete"
    assert bench.robot.pose == AWAY


async def test_the_arms_history_is_reported_at_the_start(bench: GuardedBench) -> None:
    bench.guard.history = ["2026-01-01T12:00:00Z the program died"]
    await run_procedure(bench.request(Script(move)), bench.build, bench.clock, bench.publish, bench.install)
    assert any("the program died" in str(said["text"]) for said in bench.said("warning"))


async def test_controller_that_took_the_right_back_is_not_moved(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        await ctx.move(AWAY)
        bench.robot.state = bench.robot.without_right()
        await ctx.move((0.0, 0.0, 0.0, 0.0))

    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert outcome.exit_code == ExitCode.SAFETY
    assert "operation right" in outcome.text
    assert bench.robot.calls.count("move") == 1
