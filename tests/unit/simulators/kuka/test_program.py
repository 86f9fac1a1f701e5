"""The program on the controller, on bench time: what it does with orders, STOP and heartbeat."""

import pytest

from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka.program import CYCLE_S, HEARTBEAT_S, Result
from tests.unit.simulators.kuka.benches import UPRIGHT
from tests.unit.simulators.kuka.pc import Pc


@pytest.fixture
def pc() -> Pc:
    return Pc()


def test_a_step_is_added_to_what_is_measured(pc: Pc) -> None:
    pc.write(CATS_CMD="2", CATS_AXIS="1", CATS_INC="0.01")
    pc.begin()
    pc.live(0.5)
    assert pc.result == (1, Result.DONE)
    assert pc.bench.joints == pytest.approx((0.01, *UPRIGHT[1:]), abs=1e-6)


def test_other_axes_keep_their_command_in_a_step(pc: Pc) -> None:
    pc.write(CATS_CMD="2", CATS_AXIS="6", CATS_INC="-0.5")
    pc.begin()
    pc.live(3.0)
    assert pc.bench.joints[:5] == UPRIGHT[:5]
    assert pc.bench.joints[5] == pytest.approx(-0.5, abs=1e-6)


def test_a_line_step_moves_the_flange_along_the_base(pc: Pc) -> None:
    before = pc.controller.variables
    start = {axis: float(before.read(f"$POS_ACT.{axis}")) for axis in "XYZABC"}
    pc.write(CATS_CMD="3", CATS_Y="1.0")
    pc.begin()
    pc.live(1.0)
    assert pc.result == (1, Result.DONE)
    for axis in "XZABC":
        assert float(pc.read(f"$POS_ACT.{axis}")) == pytest.approx(start[axis], abs=2e-3)
    assert float(pc.read("$POS_ACT.Y")) == pytest.approx(start["Y"] + 1.0, abs=1e-3)


def test_a_step_is_slow(pc: Pc) -> None:
    pc.controller.variables.write("$OV_PRO", "10")
    pc.write(CATS_CMD="2", CATS_AXIS="1", CATS_INC="0.123")
    pc.begin()
    # 0.1 % of A1's 123 °/s.
    pc.live(0.8)
    assert pc.read("CATS_MOVING") == "TRUE"
    pc.live(0.3)
    assert pc.result == (1, Result.DONE)


def test_a_step_to_a_pose_is_slow(pc: Pc) -> None:
    pc.controller.variables.write("$OV_PRO", "10")
    pc.write(CATS_CMD="4", CATS_GOAL="{A1 0.123,A2 -90,A3 90,A4 0,A5 30,A6 0}")
    pc.begin()
    # 0.1 % of A1's 123 °/s.
    pc.live(0.8)
    assert pc.read("CATS_MOVING") == "TRUE"
    pc.live(0.3)
    assert pc.result == (1, Result.DONE)
    assert pc.bench.joints == pytest.approx((0.123, *UPRIGHT[1:]), abs=1e-6)


def test_an_order_is_carried_out_once(pc: Pc) -> None:
    pc.write(CATS_CMD="2", CATS_AXIS="1", CATS_INC="0.01")
    pc.begin()
    pc.live(0.5)
    pc.write(CATS_SEQ="1")
    pc.live(0.5)
    assert pc.bench.joints[0] == pytest.approx(0.01, abs=1e-6)


@pytest.mark.parametrize(
    ("values", "result"),
    [
        ({"CATS_CMD": "2", "CATS_AXIS": "1", "CATS_INC": "1.1"}, Result.TOO_LARGE),
        ({"CATS_CMD": "3", "CATS_X": "1.5", "CATS_Z": "-1.5"}, Result.TOO_LARGE),
        ({"CATS_CMD": "4", "CATS_GOAL": "{A1 0,A2 -90,A3 90,A4 0,A5 30,A6 1.1}"}, Result.TOO_LARGE),
        ({"CATS_CMD": "2", "CATS_AXIS": "7", "CATS_INC": "0.1"}, Result.UNKNOWN),
        ({"CATS_CMD": "9"}, Result.UNKNOWN),
        ({"CATS_CMD": "2", "CATS_AXIS": "1", "CATS_STOP": "TRUE"}, Result.STOP_STANDS),
    ],
)
def test_an_order_that_is_refused_moves_nothing(pc: Pc, values: dict[str, str], result: Result) -> None:
    pc.write(**values)
    pc.begin()
    pc.live(0.5)
    assert pc.result == (1, result)
    assert pc.bench.joints == UPRIGHT


def test_an_order_that_was_revoked_moves_nothing(pc: Pc) -> None:
    pc.write(CATS_CMD="2", CATS_AXIS="1", CATS_INC="0.1", CATS_FOR="0", CATS_SEQ="1")
    pc.live(0.5)
    assert pc.result == (1, Result.NOT_PREPARED)
    assert pc.bench.joints == UPRIGHT


def test_stop_brakes_within_a_cycle(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    before = pc.bench.joints
    pc.write(CATS_STOP="TRUE")
    pc.bench.advance(2 * CYCLE_S)
    pc.bench.advance(0.1)
    stood = pc.bench.joints
    # 12.3 °/s for a cycle, and a deceleration of 500 °/s².
    assert 0.0 <= stood[0] - before[0] < 12.3 * 2 * CYCLE_S + 12.3**2 / (2 * 500.0)
    assert pc.result == (1, Result.STOPPED)
    pc.live(1.0)
    assert pc.bench.joints == stood


def test_the_arm_stops_half_a_second_after_the_last_heartbeat(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(2.0)
    last_s = pc.bench.time_s
    pc.bench.advance(HEARTBEAT_S - 0.15)
    assert pc.read("CATS_MOVING") == "TRUE"
    pc.bench.advance(0.15 + CYCLE_S + 0.1)
    assert pc.bench.standstill_s - last_s < HEARTBEAT_S + CYCLE_S + 0.05
    assert pc.result == (1, Result.NO_HEARTBEAT)


def test_an_override_of_0_holds_the_arm(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    pc.controller.variables.write("$OV_PRO", "0")
    pc.live(0.5)
    stood = pc.bench.joints
    pc.live(2.0)
    assert pc.bench.joints == stood
    assert pc.read("CATS_MOVING") == "TRUE"


def test_a_motion_goes_on_with_the_override(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    pc.controller.variables.write("$OV_PRO", "0")
    pc.live(0.5)
    pc.controller.variables.write("$OV_PRO", "100")
    pc.live(3.0)
    assert pc.result == (1, Result.DONE)
    assert pc.bench.joints[0] == 90.0


@pytest.mark.parametrize("press", ["stop", "T1"])
def test_the_panel_holds_a_motion_until_start(pc: Pc, press: str) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    pc.controller.press(press)
    pc.live(0.5)
    assert pc.read("$PRO_STATE") == "#P_STOP"
    assert not pc.bench.moving
    pc.write(CATS_BEAT="TRUE")
    pc.controller.press("start")
    pc.bench.advance(CYCLE_S)
    assert pc.read("$PRO_STATE") == "#P_ACTIVE"


def test_a_motion_held_too_long_does_not_go_on(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    pc.controller.press("stop")
    pc.bench.advance(5.0)
    stood = pc.bench.joints
    pc.controller.press("start")
    pc.bench.advance(1.0)
    assert pc.result == (1, Result.NO_HEARTBEAT)
    assert pc.bench.joints == pytest.approx(stood, abs=0.2)


def test_an_emergency_stop_needs_its_release_drives_and_start(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    pc.controller.set_emergency_stop(on=True)
    pc.bench.advance(0.5)
    assert not pc.bench.moving
    assert (pc.read("$PERI_RDY"), pc.read("$ALARM_STOP")) == ("FALSE", "FALSE")
    for key in ("drives", "start"):
        with pytest.raises(EmulatorError):
            pc.controller.press(key)
    pc.controller.set_emergency_stop(on=False)
    pc.controller.press("drives")
    pc.controller.press("start")
    assert pc.read("$PRO_STATE") == "#P_ACTIVE"


def test_a_goal_beyond_the_limits_is_a_message(pc: Pc) -> None:
    pc.write(CATS_CMD="1", CATS_GOAL="{A1 190}")
    pc.begin()
    assert pc.bench.joints == UPRIGHT
    assert (pc.read("$STOPMESS"), pc.read("$PRO_STATE")) == ("TRUE", "#P_STOP")


def test_the_mode_switch_is_read_back(pc: Pc) -> None:
    for mode in ("T1", "T2", "AUT", "EX"):
        pc.controller.press(mode)
        assert pc.read("$MODE_OP") == f"#{mode}"
    with pytest.raises(EmulatorError, match="no key"):
        pc.controller.press("F1")
