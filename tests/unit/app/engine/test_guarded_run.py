"""A run owns its arm before anything is sent to it, and ends when the guard has stopped it."""

from pathlib import Path

import pytest

from app.engine.devices import Devices, WireRecorder
from app.engine.host import run_procedure
from app.errors import ArmInUseError
from app.exitcode import ExitCode
from procedures.context import Context
from tests.unit.app.engine.fakes import AWAY, FakeBench, Script
from tests.unit.app.guard.fakes import FakeGuard


class GuardedBench(FakeBench):
    """A bench whose arm has a guard."""

    guard: FakeGuard

    def build(self, record: WireRecorder) -> Devices:
        devices = super().build(record)
        return Devices(devices.robot, devices.interferometer, devices.environment, guard=self.guard)


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


async def test_run_that_the_guard_stopped_ends_stopped_and_unacknowledged(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        bench.guard.stops("the guard stopped the arm")
        await ctx.move(AWAY)

    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.SAFETY)
    assert "stop" in bench.robot.calls
    assert "move" not in bench.robot.calls


async def test_what_a_guard_did_before_is_told_at_the_start(bench: GuardedBench) -> None:
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
