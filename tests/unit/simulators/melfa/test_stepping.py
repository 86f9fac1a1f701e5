"""STEP and breakpoints (sheet, section 1.9); letters and arguments of a public client (Palatis/Melfa.Robot)."""

import pytest

from catseye.simulators.melfa.choices import Choices
from tests.unit.simulators.melfa.desk import Desk, Talker

PROGRAM = ("MOV (10,0,0,0)", "M1=5", "MOV (20,0,0,0)", "M_OUT(3)=1", "MOV (30,0,0,0)")


def loaded(*lines: str, choices: Choices | None = None) -> tuple[Desk, Talker]:
    """Write and select a program that has not begun."""
    desk = Desk(choices=choices)
    robot = desk.client().ready()
    lines = lines or PROGRAM
    robot.do("LOAD=ABC", *(f"EDATA{n}0 {line}" for n, line in enumerate(lines, start=1)), "SAVE")
    robot.do("PRGLOAD=ABC")
    return desk, robot


def stood(robot: Talker, *commands: str) -> tuple[float, str]:
    """Give commands, each of them to its end; return J1 and the line that is next."""
    for command in commands:
        robot.do(command)
        robot.desk.bench.advance(3.0)
    return round(robot.desk.bench.joints[0], 6), robot.ask("LINENO").removeprefix("QoK")


def test_a_step_carries_out_one_line_and_pauses() -> None:
    desk, robot = loaded()
    assert stood(robot, "STEP1") == (10.0, "20")
    assert desk.controller.task.paused
    assert stood(robot, "STEPI") == (10.0, "30")
    assert robot.ask("VALM1") == "QoKM1=+5"
    assert stood(robot, "STEP=1", "STEP1") == (20.0, "50")
    assert robot.ask("OUT0") == "QoK0008"


def test_a_step_shows_run_and_then_wait() -> None:
    desk, robot = loaded()
    robot.do("OVRD=5", "STEP1")
    desk.bench.advance(0.1)
    bits = robot.ask("DSTATE").removeprefix("QoK")
    assert (int(bits[:2], 16) & 0x40, int(bits[2:4], 16) & 0x04) == (0x40, 0)
    desk.bench.advance(5.0)
    bits = robot.ask("DSTATE").removeprefix("QoK")
    assert (int(bits[:2], 16) & 0x40, int(bits[2:4], 16) & 0x04) == (0, 0x04)


def test_run_goes_on_where_a_step_has_stopped() -> None:
    _, robot = loaded()
    assert stood(robot, "STEP1", "RUN;1") == (30.0, "10")
    assert robot.ask("OUT0") == "QoK0008"


def test_the_last_step_ends_the_cycle() -> None:
    desk, robot = loaded("M1=1", "M1=M1+1")
    assert stood(robot, "STEP1", "STEP1") == (0.0, "10")
    assert not desk.controller.task.running
    assert not desk.controller.task.paused


def test_continuous_steps_end_with_the_cycle() -> None:
    desk, robot = loaded()
    assert stood(robot, "STEPR") == (30.0, "10")
    assert not desk.controller.task.running


def test_the_end_of_stepping_stops_the_motion() -> None:
    desk, robot = loaded()
    robot.do("OVRD=5", "STEPR")
    desk.bench.advance(0.2)
    robot.do("STEPS")
    desk.bench.advance(1.0)
    assert 0.0 < desk.bench.joints[0] < 10.0
    assert desk.controller.task.paused
    assert stood(robot, "OVRD=100", "STEP1") == (10.0, "20")


def test_the_end_of_stepping_leaves_a_program_that_runs() -> None:
    desk, robot = loaded()
    robot.do("OVRD=5", "RUN;1")
    desk.bench.advance(0.2)
    robot.do("STEPS")
    desk.bench.advance(60.0)
    assert desk.bench.joints[0] == pytest.approx(30.0)


def test_a_step_back_carries_out_the_last_motion_before() -> None:
    _, robot = loaded()
    stood(robot, "STEP1", "STEP1", "STEP1", "STEP1")
    assert stood(robot, "STEPB") == (20.0, "30")
    assert stood(robot, "STEPB") == (10.0, "10")
    assert robot.ask("STEPB") == "QeR311000000"
    assert stood(robot, "STEP1", "STEP1", "STEP1") == (20.0, "40")


def test_a_step_back_carries_out_any_line_if_so_chosen() -> None:
    _, robot = loaded(choices=Choices(step_back="line"))
    stood(robot, "STEP1", "STEP1", "EXECM1=7")
    assert stood(robot, "STEPB") == (10.0, "20")
    assert robot.ask("VALM1") == "QoKM1=+5"


@pytest.mark.parametrize(
    ("letters", "refused"),
    [("1I", "STEP2"), ("1I", "STEP"), ("1", "STEPI"), ("I", "STEP1"), ("1I", "STEP1I")],
)
def test_other_letters_of_step_are_refused(letters: str, refused: str) -> None:
    _, robot = loaded(choices=Choices(step_letters=letters))
    assert robot.ask(refused) == "QeR601000000"


def test_a_step_needs_the_right_and_a_program() -> None:
    desk = Desk()
    robot = desk.client()
    assert robot.ask("STEP1") == "QeR602000000"
    assert robot.ready().ask("STEP1") == "QeR510000000"
    robot.do("STOPON")
    assert robot.ask("STEP1") == "QeR561000000"


def test_a_step_on_a_locked_machine_leaves_the_arm_alone() -> None:
    desk, robot = loaded()
    robot.do("MLOCKON")
    assert stood(robot, "STEP1") == (0.0, "20")
    assert robot.ask("JPOS1").startswith("QoKJ1;10.00;")
    assert desk.bench.true_joints == (0.0, 0.0, 0.0, 0.0)


def test_a_program_pauses_before_the_line_of_a_breakpoint() -> None:
    desk, robot = loaded()
    robot.do("BRKPTSETABC;30;0")
    assert stood(robot, "RUN;1") == (10.0, "30")
    assert desk.controller.task.paused
    assert stood(robot, "RUN;1") == (30.0, "10")
    assert stood(robot, "RUN;1") == (10.0, "30")


def test_a_breakpoint_for_once_is_gone_afterwards() -> None:
    _, robot = loaded()
    robot.do("BRKPTSET=ABC;30;1")
    assert stood(robot, "RUN;1") == (10.0, "30")
    assert stood(robot, "RUN;1", "RUN;1") == (30.0, "10")


def test_a_breakpoint_at_the_first_line_holds_a_new_start() -> None:
    _, robot = loaded()
    robot.do("BRKPTSETABC;10;0")
    assert stood(robot, "RUN;1") == (0.0, "10")
    assert stood(robot, "RUN;1") == (30.0, "10")


def test_single_steps_pass_breakpoints_and_continuous_ones_do_not() -> None:
    _, robot = loaded()
    robot.do("BRKPTSETABC;10;0", "BRKPTSETABC;30;0")
    assert stood(robot, "STEP1") == (10.0, "20")
    assert stood(robot, "STEPR") == (10.0, "30")
    assert stood(robot, "STEP1") == (20.0, "40")


@pytest.mark.parametrize("clear", ["BRKPTCLR=ABC;30", "BRKPTCLRABC;0", "BRKPTCLR=ABC"])
def test_a_cleared_breakpoint_holds_nothing(clear: str) -> None:
    _, robot = loaded()
    robot.do("BRKPTSETABC;30;0", clear)
    assert stood(robot, "RUN;1") == (30.0, "10")


@pytest.mark.parametrize(
    ("command", "number"),
    [
        ("BRKPTSETXYZ;10;0", 4140),
        ("BRKPTSETABC;15;0", 3110),
        ("BRKPTSETABC;10;2", 3110),
        ("BRKPTCLRXYZ", 4140),
    ],
)
def test_wrong_breakpoints_are_refused(command: str, number: int) -> None:
    _, robot = loaded()
    assert robot.ask(command) == f"QeR{number}00000"


def test_breakpoints_are_listed_only_if_so_chosen() -> None:
    """No source gives the layout."""
    _, robot = loaded()
    assert robot.ask("BRKPTGET") == "QeR601000000"
    _, robot = loaded(choices=Choices(lists_breakpoints=True))
    assert robot.ask("BRKPTGET") == "QoK"
    robot.do("BRKPTSETABC;30;1", "BRKPTSETABC;10;0")
    assert robot.ask("BRKPTGETABC") == "QoKABC;10;0\vABC;30;1;2;0"
