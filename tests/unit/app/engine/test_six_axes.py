"""Gate, tubes, rehearsal and moves of an arm with six axes."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.engine.before_motion import beyond
from catseye.app.engine.driven import sampled, speeds_of
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.walked.register import as_row
from catseye.app.engine.walked.tube import Leg, Tubes, legs_through, walking_percent
from catseye.app.errors import LimitError
from catseye.app.results.runs.event_text import first_motion_text
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.clear_way import way_check
from catseye.procedures.kit.system import System
from tests.unit.app.engine.fakes import FakeBench, FakeRobot, ManualClock, Script
from tests.unit.app.engine.runs import run
from tests.unit.procedures.six_axes import AXES, BENCH, REACH_MM, STRETCHED, with_post

ASIDE: Pose = (90.0, 0.0, 0.0, 0.0, 0.0, 0.0)
TURNED: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 84.0)


def leg(start: float, end: float, *, beside: float = 0.0) -> Leg:
    """Return a motion of the fourth axis with the sixth beside zero."""
    return Leg((0.0, 0.0, 0.0, start, 0.0, beside), (0.0, 0.0, 0.0, end, 0.0, beside))


def test_a_tube_is_a_degree_wide_in_every_axis() -> None:
    tubes = Tubes(AXES, [leg(0.0, 20.0)])
    assert tubes.covers(leg(5.0, 15.0, beside=0.99))
    assert not tubes.covers(leg(5.0, 15.0, beside=1.01))
    assert not tubes.covers(leg(5.0, 21.01))


def test_cut_corners_are_told_of_all_axes() -> None:
    first, last = legs_through(STRETCHED, [TURNED, (0.0, 0.0, 10.0, 0.0, 0.0, 84.0)], blended=True)
    assert first.cut == last.cut == (0.0, 0.0, 5.0, 0.0, 0.0, 42.0)
    assert as_row(first) == {"from": list(STRETCHED), "to": list(TURNED)}


def test_a_motion_is_walked_at_250_mm_a_second() -> None:
    # With 1 % the first axis turns at 2.5 deg/s; nothing is farther from it than 270 + hypot(70, 302) + 200 + 50 mm.
    assert walking_percent(BENCH, Leg(STRETCHED, ASIDE), 20.0) == 250.0 // (830.006 * math.radians(2.5))


def test_samples_of_a_way_have_all_axes() -> None:
    poses = sampled(STRETCHED, [TURNED])
    assert poses.shape == (337, 6)
    assert poses[168] == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.0, 42.0])


def test_the_tool_speed_follows_from_its_circle() -> None:
    speeds = speeds_of(System(BENCH), STRETCHED, [ASIDE])
    assert speeds.joint_deg_s == pytest.approx(25.0)
    assert speeds.tool_mm_s == pytest.approx(REACH_MM * math.radians(25.0), rel=1e-4)


async def test_a_rehearsal_drives_six_axes_without_a_beam() -> None:
    dry = DryRunContext(System(BENCH), STRETCHED)
    await dry.follow((TURNED,))
    assert dry.total_s == pytest.approx(2.042)
    assert dry.motions == [Leg(STRETCHED, TURNED)]
    assert not (await dry.beam()).beam_ok
    with pytest.raises(LimitError, match="A5 = 130 deg is outside -120 … 120 deg"):
        await dry.move((0.0, 0.0, 0.0, 0.0, 130.0, 0.0))


async def test_the_gate_checks_ranges_and_bodies_of_six_axes() -> None:
    bench = with_post(45.0)
    robot = FakeRobot(ManualClock(), pose=STRETCHED)
    robot.state = replace(robot.state, servo_on=True, override_percent=10.0)
    gate = MotionGate(robot, AXES, way_check(bench), 10.0)
    await gate.require((10.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(LimitError, match="A2 = 111 deg is outside"):
        await gate.require((0.0, 111.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(LimitError, match="keep-out box post"):
        await gate.require(ASIDE)


def test_ranges_beyond_the_controllers_name_their_key() -> None:
    own = [axis.range for axis in AXES]
    assert beyond(BENCH.arm, own) == []
    (trouble,) = beyond(BENCH.arm, [*own[:3], (-100.0, 160.0), *own[4:]])
    assert "robot.limits_deg.a4 = [-160, 160] goes beyond the controller's own limits -100…160" in trouble


async def test_a_run_drives_six_axes(tmp_path: Path) -> None:
    bench = FakeBench(tmp_path)
    bench.robot.pose = STRETCHED
    asked: list[Sequence[Pose]] = []

    def blocked(way: Sequence[Pose]) -> str | None:
        asked.append(way)
        return None

    outcome = await run(bench, Script(lambda ctx: ctx.move(TURNED)), driven=BENCH.arm, blocked=blocked)
    assert (outcome.status, bench.robot.pose) == ("complete", TURNED)
    assert asked == [(STRETCHED, TURNED)]
    (first,) = (entry for entry in bench.published if entry["event"] == "first-motion")
    axes = [{"name": f"A{number}", "unit": "deg"} for number in range(1, 7)]
    data = {"stands": list(STRETCHED), "way": [list(TURNED)], "axes": axes}
    assert first["data"] == data
    assert first_motion_text(data).endswith("A4 0.00° A5 0.00° A6 84.00°")
