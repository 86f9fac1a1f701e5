"""TOOL and BASE have effect; system variables cannot be overwritten (sheet, sections 1.9 and 1.14)."""

import math

import numpy as np
import pytest

from catseye.simulators.melfa.choices import Choices
from tests.unit.simulators.melfa.desk import Desk, Talker

L1, L2 = 325.0, 225.0


def flange(desk: Desk) -> tuple[float, float, float]:
    """Return x and y in mm and direction in rad by two links, not by the emulator's own geometry."""
    j1, j2, _, j4 = (math.radians(value) for value in desk.bench.joints)
    x_mm = L1 * math.cos(j1) + L2 * math.cos(j1 + j2)
    return x_mm, L1 * math.sin(j1) + L2 * math.sin(j1 + j2), j1 + j2 + j4


def tip(desk: Desk, ahead_mm: float) -> tuple[float, float]:
    x_mm, y_mm, turned = flange(desk)
    return x_mm + ahead_mm * math.cos(turned), y_mm + ahead_mm * math.sin(turned)


def place(robot: Talker) -> tuple[float, float, float, float]:
    """Return X, Y, Z in mm and C in deg as PPOSF answers them (six axes)."""
    fields = robot.ask("PPOSF").removeprefix("QoK").split(";")
    shown = dict(zip(fields[:-1:2], fields[1::2], strict=False))
    return float(shown["X"]), float(shown["Y"]), float(shown["Z"]), float(shown["C"])


def ready(choices: Choices | None = None) -> tuple[Desk, Talker]:
    desk = Desk(choices=choices)
    return desk, desk.client().ready()


def test_a_tool_shifts_the_position_that_is_shown() -> None:
    desk, robot = ready()
    robot.do("EXEC2=MOV J_CURR", "EXECJ1=(30,40,20,20)", "EXEC2=MOV J1", "EXECTOOL (100,0,15,0,0,10)")
    x_mm, y_mm = tip(desk, 100.0)
    # J1 + J2 + J4 = 90 deg: the tool stands along y.
    assert place(robot) == pytest.approx((x_mm, y_mm, 35.0, 100.0), abs=0.006)
    assert robot.ask("VALP_TOOL") == "QoKP_TOOL=(+100.00,+0.00,+15.00,+0.00,+0.00,+10.00)(0,0)"
    robot.do("EXECTOOL P_NTOOL")
    assert place(robot) == pytest.approx((*flange(desk)[:2], 20.0, 90.0), abs=0.006)


def test_a_motion_brings_the_tool_to_the_place() -> None:
    desk, robot = ready()
    robot.do("EXECTOOL (50,0,0,0,0,0)", "EXEC2=MOV (400,60,10,0,0,45)(4,0)")
    # A thousandth of a degree of J1, the controller's step, is 10 um there.
    assert tip(desk, 50.0) == pytest.approx((400.0, 60.0), abs=0.01)
    assert math.degrees(flange(desk)[2]) == pytest.approx(45.0, abs=0.002)


def test_the_tip_of_a_turning_tool_goes_straight_at_spd() -> None:
    desk, robot = ready()
    robot.do("EXECTOOL (50,0,0,0,0,0)", "EXEC2=MOV (400,-30,10,0,0,0)(4,0)", "EXECSPD 10")
    began_s = desk.bench.time_s
    robot.do("EXECMVS (400,30,10,0,0,90)(4,0)")
    seen = []
    while desk.bench.moving:
        desk.bench.advance(0.01)
        seen.append(tip(desk, 50.0))
    off_mm = np.abs(np.array(seen)[:, 0] - 400.0)
    # Between knots 1 deg apart the tip bulges by 50 mm (1 - cos 0.5 deg) at most; the start is rounded.
    assert off_mm.max() < 50.0 * (1.0 - math.cos(math.radians(0.5))) + 0.01
    assert desk.bench.standstill_s - began_s == pytest.approx(6.002, abs=0.002)


@pytest.mark.parametrize(("placed_by_world", "x_mm", "y_mm"), [(False, -125.0, 325.0), (True, 225.0, -225.0)])
def test_a_base_moves_the_origin(placed_by_world: bool, x_mm: float, y_mm: float) -> None:
    """The arm at (325, 225): turned by 90 deg and shifted by 100 mm, or the reverse of that."""
    desk, robot = ready(Choices(base_places_world=placed_by_world))
    robot.do("EXEC2=MOV (0,90,0,0)", "EXECBASE (100,0,0,0,0,90)")
    assert place(robot)[:2] == pytest.approx((x_mm, y_mm), abs=0.006)
    assert robot.ask("VALP_BASE") == "QoKP_BASE=(+100.00,+0.00,+0.00,+0.00,+0.00,+90.00)(0,0)"
    robot.do("EXEC2=MOV P_CURR")
    assert desk.bench.joints == pytest.approx((0.0, 90.0, 0.0, 0.0), abs=0.002)
    robot.do("EXECBASE P_NBASE")
    assert place(robot)[:2] == pytest.approx((325.0, 225.0), abs=0.006)


@pytest.mark.parametrize("statement", ["TOOL", "TOOL J1", "BASE M1", "BASE 1,2"])
def test_what_is_no_position_is_no_tool(statement: str) -> None:
    _, robot = ready()
    robot.do("EXECJ1=(0,0,0,0)", "EXECM1=1")
    assert robot.ask(f"EXEC{statement}") == "QeR422000000"


def test_the_number_of_the_tool_is_taken() -> None:
    _, robot = ready()
    robot.do("EXECM_TOOL=3")
    assert robot.ask("VALM_TOOL") == "QoKM_TOOL=+3"
    assert robot.ask("TOOLRD") == "QoK3"
    assert robot.ask("EXECM_TOOL=17") == "QeR311000000"
    assert robot.ask("EXECM_TOOL=1.5") == "QeR311000000"


@pytest.mark.parametrize("command", ["EXECM_SVO=0", "VAL=M_ERR=1", "VAL=P_CURR=P_TOOL", "EXECJ_FBC=J_CURR"])
def test_what_the_controller_measures_cannot_be_written(command: str) -> None:
    desk, robot = ready()
    assert robot.ask(command) == "QeR422000000"
    assert not desk.controller.variables


def test_the_refusal_of_such_a_write_can_be_chosen() -> None:
    _, robot = ready(Choices(read_only_number=3110))
    assert robot.ask("EXECM_SVO=0") == "QeR311000000"
    assert robot.ask("EXECDEF POS P_CURR") == "QeR435000000"
