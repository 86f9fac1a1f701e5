"""Machine lock (sheet, sections 1.9 and 1.10): motions are carried out and the arm stands."""

import pytest

from catseye.simulators.melfa.choices import Choices
from tests.unit.simulators.melfa.desk import Desk, Talker

LOCKED = 0x04
STATE_BITS = 4
"""Field of STATE with the status bits."""


def run_bits(robot: Talker) -> int:
    return int(robot.ask("STATE").split(";")[STATE_BITS][:2], 16)


def locked(choices: Choices | None = None) -> tuple[Desk, Talker]:
    desk = Desk(choices=choices)
    robot = desk.client().ready()
    robot.do("MLOCKON")
    return desk, robot


def joint(robot: Talker) -> float:
    return float(robot.ask("JPOSF").split(";")[1])


def test_state_shows_the_lock_while_it_lasts() -> None:
    desk = Desk()
    robot = desk.client()
    assert not run_bits(robot) & LOCKED
    # Section 1.7: no operation right is needed.
    robot.do("MLOCKON")
    assert run_bits(robot) & LOCKED
    assert int(robot.ask("DSTATE").removeprefix("QoK")[:2], 16) & LOCKED
    robot.do("MLOCKOFF")
    assert not run_bits(robot) & LOCKED


def test_a_locked_arm_stands_while_its_motion_takes_its_time() -> None:
    desk, robot = locked()
    start = desk.bench.joints
    began_s = desk.bench.time_s
    assert robot.ask("EXEC2=MOV (30,40,0,0)") == "QoK"
    assert desk.bench.time_s - began_s > 0.1
    assert desk.bench.joints == desk.bench.true_joints == start
    assert robot.ask("VALJ_FBC") == "QoKJ_FBC=(+0.00,+0.00,+0.00,+0.00)"


def test_positions_of_a_locked_arm_follow_its_commands() -> None:
    desk, robot = locked()
    robot.do("EXECMOV (30,0,0,0)")
    assert run_bits(robot) & 0x40
    desk.bench.advance(0.05)
    assert 0.0 < joint(robot) < 30.0
    desk.bench.advance(5.0)
    assert joint(robot) == 30.0
    assert robot.ask("VALJ_CURR") == "QoKJ_CURR=(+30.00,+0.00,+0.00,+0.00)"
    assert not run_bits(robot) & 0x40


def test_positions_of_a_locked_arm_stay_if_so_chosen() -> None:
    _, robot = locked(Choices(lock_shows_commands=False))
    robot.do("EXEC2=MOV (30,0,0,0)")
    assert joint(robot) == 0.0


def test_without_lock_the_arm_moves_from_where_it_is() -> None:
    desk, robot = locked()
    robot.do("EXEC2=MOV (30,0,0,0)", "MLOCKOFF")
    assert joint(robot) == 0.0
    robot.do("EXEC2=MOV (5,0,0,0)")
    assert desk.bench.joints[0] == pytest.approx(5.0)


@pytest.mark.parametrize(("first", "then"), [("MLOCKOFF", "MLOCKON"), ("MLOCKON", "MLOCKOFF")])
def test_the_lock_cannot_be_switched_during_a_motion(first: str, then: str) -> None:
    desk = Desk()
    robot = desk.client().ready()
    robot.do(first, "EXECMOV (30,0,0,0)")
    desk.bench.advance(0.05)
    assert robot.ask(then) == "QeR564000000"
    robot.do(first)
    desk.bench.advance(5.0)
    robot.do(then)


def test_a_program_runs_through_on_a_locked_machine() -> None:
    desk, robot = locked()
    robot.do("LOAD=ABC", "EDATA1 MOV (30,40,0,0)", "EDATA2 M_OUT(3)=1", "SAVE", "RUNABC;1")
    desk.bench.advance(10.0)
    assert robot.ask("OUT0") == "QoK0008"
    assert desk.bench.joints == (0.0, 0.0, 0.0, 0.0)


def test_stop_ends_a_motion_of_a_locked_machine() -> None:
    desk, robot = locked()
    other = desk.client()
    robot.do("OVRD=5", "EXECMOV (90,0,0,0)")
    desk.bench.advance(0.2)
    other.do("STOP")
    desk.bench.advance(1.0)
    assert 0.0 < joint(robot) < 90.0
    assert not run_bits(robot) & 0x40


def test_a_jog_of_a_locked_machine_leaves_the_arm_alone() -> None:
    desk, robot = locked()
    robot.do("JOG00;00;00;01;00")
    desk.bench.advance(2.0)
    assert joint(robot) > 1.0
    assert desk.bench.joints[0] == 0.0
