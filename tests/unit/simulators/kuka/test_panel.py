"""What an operator does at the smartPAD after a point that the arm cannot reach."""

import pytest

from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka.panel import PanelOptions
from catseye.simulators.kuka.program import Result
from tests.unit.simulators.kuka.benches import UPRIGHT
from tests.unit.simulators.kuka.pc import Pc


@pytest.fixture
def pc() -> Pc:
    return Pc()


def refused(pc: Pc) -> None:
    """Give an order beyond the software limit of A1, 185 deg."""
    pc.write(CATS_CMD="1", CATS_GOAL="{A1 190}")
    pc.begin()
    assert stands(pc)


def stands(pc: Pc) -> bool:
    """Return whether the program stands at a message."""
    return (pc.read("$STOPMESS"), pc.read("$PRO_STATE")) == ("TRUE", "#P_STOP")


def press(pc: Pc, *keys: str) -> None:
    for key in keys:
        pc.controller.press(key)


def moves(pc: Pc) -> bool:
    """Give an order within the limits; return whether it is carried out."""
    pc.write(CATS_CMD="2", CATS_AXIS="6", CATS_INC="0.01")
    pc.begin()
    pc.live(0.5)
    return pc.result == (pc.number, Result.DONE)


def test_a_refused_point_is_refused_again_at_the_next_start(pc: Pc) -> None:
    refused(pc)
    with pytest.raises(EmulatorError, match="a message"):
        press(pc, "start")
    press(pc, "confirm", "start")
    assert stands(pc)
    assert pc.bench.joints == UPRIGHT


def test_confirm_reset_and_start_take_orders_again(pc: Pc) -> None:
    refused(pc)
    press(pc, "confirm", "reset")
    assert pc.read("$PRO_STATE") == "#P_RESET"
    press(pc, "start")
    assert (pc.read("$STOPMESS"), pc.read("$PRO_STATE")) == ("FALSE", "#P_ACTIVE")
    assert (pc.read("CATS_TAKEN"), pc.read("CATS_DONE"), pc.read("CATS_MOVING")) == ("1", "1", "FALSE")
    pc.live(1.0)
    assert pc.bench.joints == UPRIGHT
    assert moves(pc)


def test_an_order_from_before_the_start_moves_nothing(pc: Pc) -> None:
    press(pc, "stop", "reset")
    pc.write(CATS_CMD="2", CATS_AXIS="1", CATS_INC="0.5", CATS_FOR="1", CATS_SEQ="1")
    press(pc, "start")
    pc.live(1.0)
    assert pc.bench.joints == UPRIGHT
    assert pc.read("CATS_DONE") == "1"


def test_a_reset_gives_up_the_motion_that_was_held(pc: Pc) -> None:
    pc.begin_long_move()
    pc.live(0.5)
    press(pc, "stop")
    pc.live(0.5)
    stood = pc.bench.joints
    press(pc, "reset", "start")
    pc.live(1.0)
    assert pc.bench.joints == stood
    assert pc.read("CATS_DONE") == "1"


def test_a_running_program_is_not_reset(pc: Pc) -> None:
    with pytest.raises(EmulatorError, match="press stop before"):
        press(pc, "reset")


def test_block_coincidence_halts_where_an_operator_stands_by(pc: Pc) -> None:
    press(pc, "AUT", "reset", "start")
    assert pc.read("$PRO_STATE") == "#P_STOP"
    press(pc, "start")
    assert pc.read("$PRO_STATE") == "#P_ACTIVE"
    assert moves(pc)


def test_a_controller_may_neither_halt_nor_ask_for_confirmation(pc: Pc) -> None:
    pc.controller.panel.options = PanelOptions(limit_needs_confirm=False, bco_halts=False)
    refused(pc)
    press(pc, "AUT", "reset", "start")
    assert moves(pc)


def test_jog_keys_turn_an_axis_by_hand(pc: Pc) -> None:
    for keys, why in ((("A1+",), "program runs"), (("stop", "A1+"), "T1")):
        with pytest.raises(EmulatorError, match=why):
            press(pc, *keys)
    press(pc, "T1", "A1+")
    pc.bench.advance(1.0)
    press(pc, "A6-")
    pc.bench.advance(1.0)
    assert pc.bench.joints == pytest.approx((1.0, *UPRIGHT[1:5], -1.0))


def at_a1(pc: Pc, a1_deg: float) -> None:
    """Put the arm there, as if its software limits had been others."""
    pc.bench.move_to((a1_deg, *UPRIGHT[1:]))
    pc.bench.advance(10.0)


def test_an_axis_is_jogged_as_far_as_its_limit(pc: Pc) -> None:
    at_a1(pc, 184.7)
    press(pc, "T1", "A1+")
    pc.bench.advance(1.0)
    assert pc.bench.joints[0] == pytest.approx(185.0)
    with pytest.raises(EmulatorError, match="software limit"):
        press(pc, "A1+")


def test_an_axis_beyond_its_limit_is_jogged_back(pc: Pc) -> None:
    at_a1(pc, 185.5)
    press(pc, "stop", "reset", "start")
    assert pc.read("$STOPMESS") == "TRUE"
    press(pc, "T1")
    with pytest.raises(EmulatorError, match="software limit"):
        press(pc, "A1+")
    press(pc, "A1-")
    pc.bench.advance(1.0)
    assert pc.bench.joints[0] == pytest.approx(184.5)
    press(pc, "EX", "confirm", "reset", "start")
    assert moves(pc)


def test_a_line_beyond_the_limits_is_refused_and_moves_nothing(pc: Pc) -> None:
    # A1 = 184.99 deg points along -X; +A1 is clockwise and leads towards +Y, 0.065 deg in 2 mm at 1.75 m.
    at_a1(pc, 184.99)
    stood = pc.bench.joints
    pc.write(CATS_CMD="3", CATS_Y="2.0")
    pc.begin()
    pc.live(1.0)
    assert stands(pc)
    assert pc.bench.joints == stood


def test_faults_are_cleared_after_a_refused_point(pc: Pc) -> None:
    refused(pc)
    pc.controller.clear_faults()
    assert moves(pc)
