"""The controller's emulator against the telegrams of the sheet: exact, or in layout where values differ."""

import re

import pytest

from tests.transcripts import melfa_r3 as sheet
from tests.transcripts.melfa_r3 import Exchange
from tests.unit.simulators.melfa.desk import Desk, Talker, with_axes


def layout(answer: str) -> str:
    """Return an answer with its numbers left open, but not their decimals, and the case of its prefix."""
    return "QoK" + re.sub(r"-?\d+(?:\.(\d+))?", lambda n: f"#{len(n[1] or '')}", answer[3:])


def answer_to(exchange: Exchange, robot: Talker) -> str:
    return robot.ask(exchange.request)


@pytest.mark.parametrize(
    ("exchange", "axes", "before"),
    [
        (sheet.STATE_IDLE, 4, ()),
        (sheet.SIGNALS, 4, ("OUT=0;0002",)),
        (sheet.ORIGIN, 6, ()),
        (sheet.NO_ERROR, 4, ()),
        (sheet.NUMBER, 4, ("VAL=M1=3",)),
        (sheet.LINE_COUNT, 4, ("LOAD=ABC", *(f"EDATA{n} MOV P1" for n in range(1, 6)))),
        (sheet.LANGUAGE, 6, ()),
        (sheet.TOOL, 6, ()),
        (sheet.NO_RIGHT, 4, ()),
    ],
)
def test_answers_are_those_of_the_sheet(exchange: Exchange, axes: int, before: tuple[str, ...]) -> None:
    robot = Desk(with_axes(axes)).client()
    robot.do(*before)
    assert answer_to(exchange, robot) == exchange.answer


def test_answers_needing_preparation_match_the_sheet() -> None:
    desk = Desk()
    robot = desk.client().ready()
    assert answer_to(sheet.SERVO, robot) == sheet.SERVO.answer
    desk.controller.raise_alarm(4140)
    assert answer_to(sheet.ERROR, robot) == sheet.ERROR.answer
    (refused,) = robot.send(f"1;99;{sheet.BAD_SLOT.request}\r".encode())
    assert robot.finish(refused) == sheet.BAD_SLOT.answer


@pytest.mark.parametrize(
    ("exchange", "axes"),
    [
        (sheet.JOINTS_SIX, 6),
        (sheet.JOINTS_EIGHT, 8),
        (sheet.POSITION_SIX, 6),
        (sheet.TIME, 4),
        (sheet.DSTATE, 4),
    ],
)
def test_the_layout_is_that_of_the_sheet(exchange: Exchange, axes: int) -> None:
    robot = Desk(with_axes(axes)).client()
    assert layout(answer_to(exchange, robot)) == layout(exchange.answer)


def test_the_sheets_joints_match_in_four_axes() -> None:
    robot = Desk(with_axes(6)).client().ready()
    robot.do("OVRD=75", "EXEC2=MOV (-16.28,38.72,102.51,16.73)")
    expected = sheet.JOINTS_SIX.answer.replace("J5;6.06;J6;-19.16", "J5;0.00;J6;0.00")
    assert robot.ask("JPOSF") == expected


@pytest.mark.parametrize(("exchange", "axes"), [(sheet.OPEN_SIX, 6), (sheet.OPEN_EIGHT, 8)])
def test_the_fields_of_open_are_those_of_the_sheet(exchange: Exchange, axes: int) -> None:
    said = Desk(with_axes(axes)).client().ask(exchange.request).split(";")
    wanted = exchange.answer.split(";")
    assert len(said) == len(wanted)
    assert said[:4] == wanted[:4]
    for place in (5, 8, 11, 13, 15, 16):
        assert said[place] == wanted[place]
    assert re.fullmatch(r"\d\d-\d\d-\d\d", said[9])
    assert said[10].startswith("Ver.")


def test_a_position_value_has_the_layout_of_the_sheet() -> None:
    robot = Desk().client()
    robot.do("VAL=P1=(400.13,0,644.62,180,0,180)(7,0)")
    said = robot.ask("VALP1")
    # A SCARA has neither A nor B.
    assert said == sheet.POSITION_VALUE.answer.replace("+644.62,+180.00", "+644.62,+0.00")


def test_the_directory_has_the_layout_of_the_sheet() -> None:
    robot = Desk().client()
    robot.do("LOAD=1", "EDATA10 MOV P1", "EDATAP1=(400,0,0,0,0,0)(4,0)", "SAVE", "LOAD=2", "SAVE")
    said, wanted = robot.ask("PDIRTOP").split(";"), sheet.DIRECTORY.answer.split(";")
    assert len(said) == len(wanted) == 13
    assert (said[0], said[3], said[6], said[7], said[8]) == ("QoK1.MB6", "2", "", "1", "1")
    assert re.fullmatch(r"\d\d-\d\d-\d\d\d\d:\d\d:\d\d", said[2])
    second = robot.ask("PDIR2").split(";")
    assert second[0] == "QoK2.MB6"
    assert len(second) == len(wanted) - 2
    assert robot.ask("PDIR3") == "QoK"


def test_observed_composites_of_state_come_from_the_same_situations() -> None:
    """Section 1.10; 80060 and A0060 are those of a paused program, 60000 of a running one, in one cycle."""
    desk = Desk()
    robot, watcher = desk.client().ready(), desk.client()
    robot.do("LOAD=P", "EDATA10 MOV (90,0,0,0)", "SAVE", "RUNP;1")
    desk.bench.advance(0.05)
    assert watcher.ask("DSTATE").startswith("QoK60000;")
    robot.do("STOP")
    desk.bench.advance(1.0)
    assert watcher.ask("DSTATE").startswith("QoK20060;")
    assert robot.ask("DSTATE").startswith("QoKA0060;")
    robot.do("SRVOFF")
    assert robot.ask("DSTATE").startswith("QoK80060;")


@pytest.mark.parametrize("line", sheet.REPLAYED)
def test_recorded_answers_are_rejected_and_the_line_stays_in_step(line: str) -> None:
    robot = Desk().client()
    assert robot.send(f"{line}\r1;1;OVRD\r".encode()) == [b"QeR601000000", b"QoK100"]


@pytest.mark.parametrize("commands", sheet.STARTS)
@pytest.mark.parametrize("axes", [4, 6, 8])
def test_known_clients_can_begin(commands: tuple[str, ...], axes: int) -> None:
    desk = Desk(with_axes(axes))
    robot = desk.client()
    robot.do("LOAD=COSIROP", "EDATA10 MOV P1", "SAVE")
    for command in commands:
        assert robot.ask(command).startswith("QoK"), command
