"""JOG and its dead-man (sheet, section 1.9) on the emulated controller."""

from dataclasses import replace

import pytest

from catseye.simulators.melfa.choices import Choices
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.desk import Desk, Talker

PLUS_J1, MINUS_J1, PLUS_J3 = "JOG00;00;00;01;00", "JOG00;00;01;00;00", "JOG00;00;00;04;00"


def standing_still(robot: Talker) -> bool:
    return not robot.desk.bench.moving


def test_a_jog_that_is_not_repeated_ends_after_140_ms() -> None:
    desk = Desk()
    robot = desk.client().ready()
    assert robot.ask(PLUS_J1) == "QoK"
    # 10 % of 420 deg/s after a ramp of 42 / 2000 s: 42 * 0.140 - 42 * 0.021 / 2 until the dead-man acts.
    desk.bench.advance(0.140)
    at_the_end = desk.bench.joints[0]
    assert at_the_end == pytest.approx(42.0 * 0.140 - 42.0 * 0.0105, abs=1e-6)
    desk.bench.advance(1.0)
    # Then the drives slow down at 2000 deg/s² : 42² / (2 * 2000).
    assert desk.bench.joints[0] == pytest.approx(at_the_end + 42.0**2 / 4000.0, abs=1e-6)
    assert standing_still(robot)
    assert robot.ask("ERROR") == "QoK"


def test_a_jog_ends_even_if_nobody_asks() -> None:
    one, other = Desk(), Desk()
    for desk in (one, other):
        assert desk.client().ready().ask(PLUS_J1) == "QoK"
    one.bench.advance(60.0)
    for _ in range(600):
        other.bench.advance(0.1)
    assert one.bench.joints == other.bench.joints
    assert 0.0 < one.bench.joints[0] < 10.0


def test_repeated_telegrams_keep_the_arm_moving_without_a_break() -> None:
    desk = Desk()
    robot = desk.client().ready()
    for _ in range(20):
        assert robot.ask(PLUS_J1) == "QoK"
        desk.bench.advance(0.1)
    assert desk.bench.joints[0] == pytest.approx(42.0 * 2.0 - 42.0 * 0.0105, abs=1e-6)
    desk.bench.advance(1.0)
    assert standing_still(robot)


def test_the_override_slows_a_jog_of_linear_axes() -> None:
    desk = Desk(replace(QUIET, start_joints=(0.0, 0.0, 50.0, 0.0)), Choices(jog_percent=20.0))
    robot = desk.client().ready()
    robot.do("OVRD=50", PLUS_J3)
    desk.bench.advance(0.1)
    # 1100 mm/s * 20 % * 50 %, less half a ramp of 110 / 8000 s.
    assert desk.bench.joints[2] - 50.0 == pytest.approx(110.0 * (0.1 - 110.0 / 16_000.0), abs=1e-6)


def test_another_direction_stops_first() -> None:
    desk = Desk()
    robot = desk.client().ready()
    robot.do(PLUS_J1)
    desk.bench.advance(0.1)
    robot.do(MINUS_J1)
    desk.bench.advance(0.1)
    turning = desk.bench.joints[0]
    assert standing_still(robot)
    robot.do(MINUS_J1)
    desk.bench.advance(0.1)
    assert desk.bench.joints[0] < turning


def test_stop_ends_a_jog_at_once() -> None:
    desk = Desk()
    robot, other = desk.client().ready(), desk.client()
    robot.do(PLUS_J1)
    desk.bench.advance(0.05)
    at = desk.bench.joints[0]
    other.do("STOP")
    desk.bench.advance(1.0)
    assert desk.bench.joints[0] == pytest.approx(at + 42.0**2 / 4000.0, abs=1e-6)


def test_a_jog_to_the_limit_alarms_with_servo_off() -> None:
    """Section 5.3: H216n upwards, H217n downwards."""
    desk = Desk(replace(QUIET, start_joints=(169.0, 0.0, 0.0, 0.0)))
    robot = desk.client().ready()
    robot.do(PLUS_J1)
    desk.bench.advance(0.1)
    assert desk.bench.joints[0] == pytest.approx(170.0)
    assert robot.ask("ERROR") == "Qok2161;1"
    assert robot.ask("VALM_SVO") == "QokM_SVO=+0"
    assert robot.ask(MINUS_J1) == "QeR560000000"
    robot.do("RSTALRM", "SRVON")
    desk.bench.advance(1.0)
    assert robot.ask(PLUS_J1) == "Qok"
    assert robot.ask("ERROR") == "Qok2161;1"
    robot.do("RSTALRM", "SRVON")
    desk.bench.advance(1.0)
    robot.do(MINUS_J1)
    desk.bench.advance(1.0)
    assert desk.bench.joints[0] < 170.0
    desk = Desk()
    desk.client().ready().do("JOG00;00;04;00;00")
    assert desk.controller.alarm == 2173


def test_inching_moves_by_one_step() -> None:
    desk = Desk()
    robot = desk.client().ready()
    robot.do("JOG00;00;00;02;01")
    desk.bench.advance(1.0)
    assert desk.bench.joints[1] == pytest.approx(0.1)
    robot.do("JOG00;00;02;00;02")
    desk.bench.advance(1.0)
    assert desk.bench.joints[1] == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("JOGST", "QeR601000000"),
        ("JOG", "QeR601000000"),
        ("JOG00;00;00;01", "QeR601000000"),
        ("JOG03;00;00;01;00", "QeR311000000"),
        ("JOG00;00;01;01;00", "QeR311000000"),
        ("JOG00;00;00;00;00", "QoK"),
        ("JOG00;00;00;F0;00", "QoK"),
    ],
)
def test_other_jogs(command: str, answer: str) -> None:
    robot = Desk().client().ready()
    assert robot.ask(command) == answer
    assert standing_still(robot)


def test_a_jog_needs_right_and_servo_and_no_other_motion() -> None:
    robot = Desk().client()
    assert robot.ask(PLUS_J1) == "QeR602000000"
    robot.do("CNTLON")
    assert robot.ask(PLUS_J1) == "QeR200000000"
    robot.ready().do("EXECMOV (90,0,0,0)")
    assert robot.ask(PLUS_J1) == "QeR564000000"
