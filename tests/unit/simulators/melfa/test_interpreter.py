"""A program's jumps, waits, conditions and signals (sheet, sections 1.9 and 4.2)."""

import pytest

from tests.unit.simulators.melfa.desk import Desk, Talker


def started(*lines: str, seconds: float = 5.0) -> tuple[Desk, Talker]:
    """Write a program, run one cycle of it and let time pass."""
    desk = Desk()
    robot = desk.client().ready()
    robot.do("LOAD=ABC", *(f"EDATA{n} {line}" for n, line in enumerate(lines, start=1)), "SAVE", "RUNABC;1")
    desk.bench.advance(seconds)
    return desk, robot


def number(robot: Talker, name: str) -> float:
    return float(robot.ask(f"VAL{name}").partition("=")[2])


@pytest.mark.parametrize(
    ("lines", "value"),
    [
        (("M1=2+3*4-6/3",), 12.0),
        (("M1=-(1+2)*2",), -6.0),
        (("M1=7", "M1 = M1 - 2.5 ' of which 4.5 is left"), 4.5),
        (("M1=0", "*AGAIN", "M1=M1+1", "IF M1<5 THEN GOTO *AGAIN"), 5.0),
        (("M1=0", "*AGAIN: M1=M1+1", "If M1 <> 4 GoTo *AGAIN"), 4.0),
        (("M1=1", "GOTO 4", "M1=2", "M1=M1+10"), 11.0),
        (("M1=1", "IF M1=1 AND NOT (M1>3 OR M1<0) THEN M1=20 ELSE M1=30"), 20.0),
        (("M1=1", "IF M1>=2 THEN M1=20 ELSE M1=30"), 30.0),
        (("M1=1", "IF M1=1 THEN", "M1=5", "ELSE", "M1=6", "ENDIF", "M1=M1+1"), 6.0),
        (("M1=1", "IF M1=2 THEN", "IF M1=1 THEN", "ENDIF", "ELSE", "M1=6", "ENDIF"), 6.0),
        (("M1=0", "FOR M2=1 TO 4", "M1=M1+M2", "NEXT M2"), 10.0),
        (("M1=0", "FOR M2=6 TO 2 STEP -2", "FOR M3=1 TO 2", "M1=M1+1", "NEXT", "NEXT"), 6.0),
        (("M1=3", "FOR M2=2 TO 1", "M1=4", "NEXT"), 3.0),
        (("M1=0", "GOSUB *ADD", "GOSUB *ADD", "END", "*ADD", "M1=M1+1", "RETURN"), 2.0),
    ],
)
def test_a_program_calculates_and_jumps(lines: tuple[str, ...], value: float) -> None:
    desk, robot = started(*lines)
    assert robot.ask("ERROR") == "QoK"
    assert not desk.controller.task.running
    assert number(robot, "M1") == value


def test_a_program_waits_for_an_input() -> None:
    desk, robot = started("M_OUT(3)=1", "WAIT M_IN(2)=1", "M_Out(4)=M_In(2)", "MOV (10,0,0,0)")
    assert robot.ask("OUT0") == "QoK0008"
    assert robot.ask("LINENO") == "QoK2"
    robot.do("INDMY", "IN=0;0004")
    desk.bench.advance(2.0)
    assert robot.ask("OUT0") == "QoK0018"
    assert desk.bench.joints[0] == pytest.approx(10.0)


def test_a_program_waits_for_the_servo() -> None:
    desk, robot = started("SERVO OFF", "SERVO ON", "WAIT M_SVO=1", "MOV (10,0,0,0)")
    assert robot.ask("ERROR") == "QoK"
    assert desk.bench.joints[0] == pytest.approx(10.0)


def test_a_halt_goes_on_behind_itself() -> None:
    desk, robot = started("MOV (10,0,0,0)", "HLT", "MOV (20,0,0,0)")
    assert desk.bench.joints[0] == pytest.approx(10.0)
    assert robot.ask("LINENO") == "QoK3"
    robot.do("RUN;1")
    desk.bench.advance(2.0)
    assert desk.bench.joints[0] == pytest.approx(20.0)


def test_a_stopped_loop_goes_on_where_it_was() -> None:
    desk, robot = started("FOR M1=1 TO 2", "MOV (40,0,0,0)", "DLY 1", "MOV (0,0,0,0)", "NEXT", seconds=0.1)
    robot.do("STOP")
    desk.bench.advance(1.0)
    robot.do("RUN;1")
    desk.bench.advance(10.0)
    assert robot.ask("ERROR") == "QoK"
    assert number(robot, "M1") == 3.0
    assert desk.bench.joints[0] == pytest.approx(0.0)


def test_a_program_starts_anew_without_old_returns() -> None:
    desk, robot = started("IF M_IN(1)=1 THEN GOTO *OUT", "GOSUB *HERE", "*HERE", "HLT", "*OUT", "RETURN")
    robot.do("RSTPRG", "INDMY", "IN=1;0001", "RUNABC;1")
    desk.bench.advance(1.0)
    assert robot.ask("ERROR") == "Qok4220;2"


@pytest.mark.parametrize(
    ("lines", "error"),
    [
        (("GOTO *NOWHERE",), "Qok4340;2"),
        (("GOTO 77",), "Qok4340;2"),
        (("M1=M7+1",), "Qok4340;2"),
        (("RETURN",), "Qok4220;2"),
        (("NEXT",), "Qok4220;2"),
        (("FOR M1=1 TO 3 STEP 0", "NEXT"), "Qok3110;2"),
        (("IF 1 THEN",), "Qok4220;2"),
        (("M1=1/0",), "Qok3110;2"),
        (("M1=(1",), "Qok4220;2"),
        (("M1=1 1",), "Qok4220;2"),
        (("WAIT",), "Qok4220;2"),
        (("M_OUT(999)=1",), "Qok6600;2"),
        (("M_IN(1)=1",), "Qok4220;2"),
        (("*AGAIN", "GOSUB *AGAIN"), "Qok3120;2"),
        (("MXT 1,1,10",), "Qok6130;2"),
        (("MXT 1,3,10",), "Qok4220;2"),
        (('OPEN "ENET:192.168.0.10" AS #1',), "Qok6130;2"),
        (('OPEN "COM2:" AS #1',), "Qok4220;2"),
    ],
)
def test_what_makes_no_sense_stops_the_program(lines: tuple[str, ...], error: str) -> None:
    desk, robot = started(*lines)
    assert robot.ask("ERROR") == error
    assert desk.controller.task.paused


def test_a_post_processor_of_joints_is_carried_out() -> None:
    """What a public driver sends for each joint move: the file deleted, written anew, selected and run."""
    desk = Desk()
    robot = desk.client().ready()
    assert robot.ask("FDELMRL") == "QeR414000000"
    robot.do(
        "NEW",
        "LOAD=MRL",
        "EDATA 1 J1=(10.000000,20.000000,30.000000,40.000000,0.000000,0.000000)",
        "EDATA 2 SPD 200.000",
        "EDATA 3 ACCEL 50.000",
        "EDATA 4 MOV J1",
        "SAVE",
        "RSTPRG",
        "PRGLOAD=MRL",
        "RSTPRG",
        "RUNMRL;1",
    )
    desk.bench.advance(5.0)
    assert robot.ask("ERROR") == "QoK"
    assert desk.bench.joints == pytest.approx((10.0, 20.0, 30.0, 40.0))
