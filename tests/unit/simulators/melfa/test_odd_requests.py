"""Odd requests of public clients, and answers that are lists, against the sheet `melfa`."""

import pytest

from catseye.simulators.melfa import alarms
from tests.unit.simulators.melfa.desk import Desk


def test_a_nul_ends_a_command() -> None:
    assert Desk().client().send(b"1;1;OVRD\0") == [b"QoK100"]


def test_nothing_open_is_closed_by_new() -> None:
    assert Desk().client().ask("NEW") == "QoK"


def test_new_closes_nothing_of_another_client() -> None:
    desk = Desk()
    desk.client().do("LOAD=ABC")
    assert desk.client().ask("NEW") == "QeR603000000"


@pytest.mark.parametrize("number", sorted(vars(alarms).values(), key=str))
def test_every_number_that_is_answered_is_explained(number: object) -> None:
    if not isinstance(number, int) or number < 50:
        return
    robot = Desk().client()
    four = robot.ask(f"ERRORMES{number:04d}")
    assert four.startswith("QoK")
    assert "Emulated alarm" not in four
    # With the detail, as refusals have it.
    assert robot.ask(f"ERRORMES{number:04d}00000") == four


def test_what_is_too_long_loses_nothing_after_it() -> None:
    robot = Desk().client()
    assert robot.send(b"1;1;" + b"X" * 300) == []
    assert robot.session.silence_s() is not None
    robot.session.idle()
    assert robot.answers() == [b"QeR608000000"]
    assert robot.ask("OVRD") == "QoK100"


def test_a_pause_cuts_no_command_in_two() -> None:
    robot = Desk().client()
    robot.send(b"1;1;OVR")
    short_s, robot_s = 0.02, robot.session.silence_s()
    assert robot_s is not None
    assert robot_s > short_s, "what is no command yet is waited for"
    assert robot.send(b"D=50\r") == [b"QeR602000000"]
    robot.send(b"1;1;IN0")
    assert (robot.session.silence_s() or 1.0) <= short_s


def test_an_override_is_a_whole_number_everywhere() -> None:
    robot = Desk().client().ready()
    assert robot.ask("OVRD=12.6") == "QoK13"
    assert robot.ask("OVRD") == "QoK13"
    assert robot.ask("STATE").split(";")[2] == "13"
    assert robot.ask("JPOSF").split(";")[-3] == "13"


def test_a_latched_stop_forbids_the_start() -> None:
    robot = Desk().client()
    assert robot.ask("ATENA") == "QoK0"
    robot.do("STOPON")
    assert robot.ask("ATENA") == "QoK1"
    robot.do("STOPOFF")
    assert robot.ask("ATENA") == "QoK0"


def test_no_errors_are_summed_up_as_none() -> None:
    assert Desk().client().ask("ERRSUM1") == "QoK0;000000000;;;;;0"


@pytest.mark.parametrize("command", ["VAL", "GVAL", "VALS", "GVALS"])
def test_a_class_list_begins_with_its_first_variable(command: str) -> None:
    robot = Desk().client().ready()
    robot.do("EXECM1=3", "EXECM2=4", "EXECM_A=5", "EXECM_B=6")
    first, second = ("M_A=+5", "M_B=+6") if command.startswith("G") else ("M1=+3", "M2=+4")
    several = f"QoK{first}\v{second};2;0"
    assert robot.ask(f"{command}<;M") == (several if command.endswith("S") else f"QoK{first}")


def test_the_file_directory_ends_with_the_attribute() -> None:
    robot = Desk().client().ready()
    robot.do("LOAD=ABC", "EDATA1 END", "SAVE", "FATTRIB ABC;+p")
    first = robot.ask("FDIR1").split(";")
    assert (len(first), first[0], first[-1]) == (4, "QoKABC.MB6", "1")
    every = robot.ask("FDIR<*.*").split(";")
    assert every == robot.ask("FDIRTOP").split(";")
    assert (len(every), every[3], every[-1]) == (6, "1", "1")


@pytest.mark.parametrize("word", ["EXEC", "EXEC2=", "VAL", "JOG", "OVRD=", "EDATA"])
def test_a_pause_cuts_no_word_before_its_arguments(word: str) -> None:
    """Section 1.2: a short silence completes a complete command."""
    whole, beginning = Desk().client(), Desk().client()
    assert whole.send(b"1;1;OVRD") == []
    assert beginning.send(f"1;1;{word}".encode()) == []
    assert beginning.session.silence_s() == pytest.approx(0.2)
    assert whole.session.silence_s() == pytest.approx(0.005)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("M_FBD", "+0"),
        ("M_ERRLVL", "+0"),
        ("M_IN(3)", "+0"),
        ("M_OUT(2)", "+1"),
        ("J_ECURR", "(+10000.00,+0.00,+0.00,+0.00)"),
    ],
)
def test_status_variables_of_the_sheet_are_read(name: str, value: str) -> None:
    robot = Desk().client().ready()
    robot.do("EXEC2=MOV (10,0,0,0)", "OUT=0;0004")
    assert robot.ask(f"VAL{name}") == f"QoK{name}={value}"


def test_the_level_of_an_alarm_is_read() -> None:
    robot = Desk().client()
    robot.desk.controller.raise_alarm(2602)
    assert robot.ask("VALM_ERRLVL") == "QokM_ERRLVL=+2"


@pytest.mark.parametrize("name", ["M_IN(x)", "M_IN(-1)", "M_SVO(2", "M_FBD()"])
def test_a_signal_without_a_number_is_refused(name: str) -> None:
    assert Desk().client().ask(f"VAL{name}").startswith("QeR")


def test_a_variable_of_a_missing_program_is_not_written() -> None:
    robot = Desk().client().ready()
    assert robot.ask("HOTNOPE;M1=2") == "QeR414000000"
    robot.do("LOAD=ABC", "EDATA1 END", "SAVE", "HOTABC.MB6;M1=2")
    assert robot.ask("VALM1") == "QoKM1=+2"
