"""Bodies in the way of a motion, at the gate and in the rehearsal; what is said and compared before a run moves."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from catseye.app.engine.before_motion import beyond
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.gate import MotionGate
from catseye.app.errors import LimitError
from catseye.app.exitcode import ExitCode
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.clear_way import way_check
from catseye.procedures.scara.system import ScaraSystem
from tests.unit.app.engine.fakes import ARM, HOME, FakeBench, FakeRobot, ManualClock
from tests.unit.app.engine.runs import measuring, run
from tests.unit.procedures.benches import arm_xy, bench, scara_axes, with_axes

PAPER = bench()
STANDING: Pose = (0.0, 0.0, 12.5, 0.0)
OWN = ((-170.0, 170.0), (-145.0, 145.0), (0.0, 150.0), (-360.0, 360.0))


@pytest.fixture
def bench_of_fakes(tmp_path: Path) -> FakeBench:
    return FakeBench(tmp_path / "runs")


@pytest.fixture
def robot() -> FakeRobot:
    made = FakeRobot(ManualClock(), pose=STANDING)
    made.state = replace(made.state, servo_on=True, override_percent=20.0)
    return made


async def test_the_gate_refuses_what_lies_between_two_targets(robot: FakeRobot) -> None:
    x, y = arm_xy(20.0, 0.0)
    gate = MotionGate(robot, ARM.axes, way_check(bench(places={"P1": (x, y)})), 20.0)
    with pytest.raises(
        LimitError, match=r"stand of reflector P1 stands in the arm's way.*robot was not moved"
    ):
        await gate.require((40.0, 0.0, 12.5, 0.0))
    await gate.require((-40.0, 0.0, 12.5, 0.0))


async def test_the_gate_reads_the_pose_unless_one_is_given(robot: FakeRobot) -> None:
    seen: list[Sequence[Pose]] = []

    def note(way: Sequence[Pose]) -> None:
        seen.append(way)

    gate = MotionGate(robot, ARM.axes, note, 20.0)
    await gate.require((1.0, 0.0, 12.5, 0.0))
    await gate.require((2.0, 0.0, 12.5, 0.0), here=HOME)
    await gate.require()
    assert [way[0] for way in seen] == [STANDING, HOME]


async def test_the_rehearsal_refuses_what_the_plan_would() -> None:
    dry = DryRunContext(ScaraSystem(with_axes(PAPER, j3_mm=(-200.0, 150.0))), STANDING)
    await dry.move((90.0, 0.0, 12.5, 0.0))
    dry.require_clear_ways()
    await dry.follow([(90.0, 100.0, 12.5, 0.0), (90.0, 100.0, -180.0, 0.0)])
    with pytest.raises(LimitError, match=r"the table stands in the arm's way.*target 3 of 3"):
        dry.require_clear_ways()


async def test_a_real_arm_names_what_nobody_has_confirmed(bench_of_fakes: FakeBench) -> None:
    bench_of_fakes.make_real()
    await run(bench_of_fakes, measuring(0), arm="lab-1", unconfirmed=("link 1 (J1: radius 60 mm)",))
    said = [str(event["text"]) for event in bench_of_fakes.said("warning")]
    assert any(
        "uses unconfirmed dimensions: link 1 (J1: radius 60 mm); measure them" in text for text in said
    )


async def test_an_emulated_arm_need_not_be_confirmed(bench_of_fakes: FakeBench) -> None:
    await run(bench_of_fakes, measuring(0), unconfirmed=("link 1",))
    assert not [event for event in bench_of_fakes.said("warning") if "confirmed" in str(event["text"])]


@dataclass
class TellingRobot(FakeRobot):
    """Reports limits of its own, or refuses to."""

    own: tuple[tuple[float, float], ...] = OWN
    refuses: bool = False

    async def joint_limits(self) -> tuple[tuple[float, float], ...]:
        if self.refuses:
            raise RefusedError("no such parameter", 6010)
        return self.own


async def test_ranges_beyond_the_controllers_end_a_run_before_it_moves(bench_of_fakes: FakeBench) -> None:
    bench_of_fakes.robot = TellingRobot(bench_of_fakes.clock, own=((-120.0, 170.0), *OWN[1:]))
    outcome = await run(bench_of_fakes, measuring(0))
    assert outcome.exit_code == ExitCode.SAFETY
    assert "limits_deg.j1 = [-170, 170] goes beyond the controller's own limits -120…170" in outcome.text
    assert "servo on" not in bench_of_fakes.robot.calls


async def test_a_controller_withholding_its_limits_is_reported(bench_of_fakes: FakeBench) -> None:
    bench_of_fakes.robot = TellingRobot(bench_of_fakes.clock, refuses=True)
    outcome = await run(bench_of_fakes, measuring(0))
    assert outcome.exit_code == ExitCode.DONE
    assert any("were not compared" in str(event["text"]) for event in bench_of_fakes.said("warning"))


def test_every_joint_is_compared_with_the_controller() -> None:
    narrow = ((-90.0, 90.0), (-90.0, 90.0), (10.0, 20.0), (-90.0, 90.0))
    assert beyond(ARM, OWN) == []
    assert len(beyond(replace(ARM, axes=scara_axes(j3_mm=(0.0, 50.0))), narrow)) == 4


def test_a_limit_that_is_no_number_permits_nothing() -> None:
    unknown = ((math.nan, math.nan), *OWN[1:])
    assert len(beyond(ARM, unknown)) == 1
