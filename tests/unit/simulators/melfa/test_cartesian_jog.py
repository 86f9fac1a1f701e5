"""JOG along axes of space (sheet, section 1.9) on the emulated controller."""

import math
from dataclasses import replace

import pytest

from catseye.simulators.config import Joints
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.values import Position
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.desk import Desk, Talker

START: Joints = (20.0, 60.0, 50.0, -30.0)
PLUS_X, PLUS_Y, PLUS_Z, PLUS_A, PLUS_C = "01", "02", "04", "08", "20"


def ready(choices: Choices | None = None, start: Joints = START) -> tuple[Desk, Talker]:
    desk = Desk(replace(QUIET, start_joints=start), choices)
    return desk, desk.client().ready()


def jogged(robot: Talker, mode: str, axes: str, seconds: float = 0.5) -> Position:
    """Jog for a while and let the arm come to rest; return where the tool is."""
    for _ in range(round(seconds / 0.1)):
        robot.do(f"JOG{mode};00;00;{axes};00")
        robot.desk.bench.advance(0.1)
    robot.desk.bench.advance(1.0)
    assert not robot.desk.bench.moving
    return robot.desk.controller.position()


@pytest.mark.parametrize(("axes", "along"), [(PLUS_X, (1, 0, 0)), (PLUS_Y, (0, 1, 0)), (PLUS_Z, (0, 0, 1))])
def test_a_tool_goes_straight_and_keeps_its_direction(axes: str, along: tuple[int, int, int]) -> None:
    desk, robot = ready()
    robot.do("OVRD=20")
    before = desk.controller.position()
    after = jogged(robot, "01", axes)
    went = (after.x_mm - before.x_mm, after.y_mm - before.y_mm, after.z_mm - before.z_mm)
    # 20 % of 250 mm/s; the last telegram came after 0.4 s, its dead-man acts at 0.54 s, ramps of 0.01 s.
    assert math.hypot(*went) == pytest.approx(50.0 * 0.54, rel=0.02)
    assert went == pytest.approx(tuple(math.hypot(*went) * one for one in along), abs=0.005)
    assert after.c_deg == pytest.approx(before.c_deg, abs=1e-6)


def test_a_jog_in_the_tools_axes_follows_its_direction() -> None:
    desk, robot = ready()
    robot.do("OVRD=20")
    before = desk.controller.position()
    after = jogged(robot, "02", PLUS_X)
    angle = math.degrees(math.atan2(after.y_mm - before.y_mm, after.x_mm - before.x_mm))
    assert angle == pytest.approx(before.c_deg, abs=0.01)


def test_c_turns_the_tool_where_it_is() -> None:
    desk, robot = ready()
    robot.do("EXECTOOL (0,100,0,0,0,0)", "OVRD=20")
    before = desk.controller.position()
    after = jogged(robot, "01", PLUS_C, 0.1)
    assert (after.x_mm, after.y_mm) == pytest.approx((before.x_mm, before.y_mm), abs=0.005)
    assert 5.0 < after.c_deg - before.c_deg < 10.0


def test_three_axis_xyz_leaves_j4_alone() -> None:
    desk, robot = ready()
    robot.do("OVRD=20")
    before = desk.controller.position()
    after = jogged(robot, "04", PLUS_Y)
    assert (after.x_mm, after.z_mm) == pytest.approx((before.x_mm, before.z_mm), abs=0.005)
    assert desk.bench.joints[3] == pytest.approx(START[3], abs=1e-9)
    jogged(robot, "04", PLUS_A, 0.2)
    assert desk.bench.joints[3] > START[3] + 1.0


def test_a_cylinder_turns_about_j1_and_keeps_its_radius() -> None:
    desk, robot = ready()
    robot.do("OVRD=20")
    jogged(robot, "05", PLUS_Y)
    j1, j2, j3, j4 = desk.bench.joints
    assert j1 > START[0] + 1.0
    assert (j2, j3, j4) == pytest.approx(START[1:], abs=1e-6)
    before = desk.controller.position()
    after = jogged(robot, "05", PLUS_X)
    assert math.atan2(after.y_mm, after.x_mm) == pytest.approx(math.atan2(before.y_mm, before.x_mm), abs=1e-5)
    assert math.hypot(after.x_mm, after.y_mm) > math.hypot(before.x_mm, before.y_mm) + 10.0


@pytest.mark.parametrize("j3_mm", [0.0, 50.0])
def test_the_end_of_reach_raises_an_alarm(j3_mm: float) -> None:
    """A joint that stands at its limit anyway has nothing to do with it."""
    desk, robot = ready(start=(20.0, 60.0, j3_mm, -30.0))
    for _ in range(40):
        if robot.ask(f"JOG05;00;00;{PLUS_X};00").startswith("QeR"):
            break
        desk.bench.advance(0.1)
    assert robot.ask("ERROR") == "Qok2802;2"
    assert desk.bench.joints[1] == pytest.approx(0.0, abs=0.1)


def test_a_joint_limit_is_named_in_space_too() -> None:
    desk, robot = ready()
    for _ in range(20):
        if robot.ask(f"JOG01;00;00;{PLUS_Z};00").startswith("QeR"):
            break
        desk.bench.advance(0.1)
    assert robot.ask("ERROR") == "Qok2163;1"
    assert desk.bench.joints[2] == pytest.approx(desk.controller.config.limits[2][1])


def test_inching_goes_one_step_of_millimetres() -> None:
    desk, robot = ready(Choices(inch_high=0.5))
    before = desk.controller.position()
    robot.do("JOG01;00;00;02;01")
    desk.bench.advance(1.0)
    assert desk.controller.position().y_mm - before.y_mm == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("axes", ["08", "10", "40"])
def test_axes_that_this_arm_lacks_move_nothing(axes: str) -> None:
    desk, robot = ready()
    robot.do(f"JOG01;00;00;{axes};00")
    desk.bench.advance(0.1)
    assert desk.bench.joints == START


def test_unknown_modes_of_jog_are_refused() -> None:
    _, robot = ready()
    assert robot.ask("JOG03;00;00;01;00") == "QeR311000000"
