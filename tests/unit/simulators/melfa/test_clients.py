"""Three small clients; each reads answers as the sheet says that a known client does.

Sections 1.2, 1.8, 1.10 and 1.11: one takes strict patterns with six to eight axes and one `recv` an answer, one
sends bare segments and looks at three letters, one ends with LF, writes no header and keywords in small letters.
"""

import re
from dataclasses import replace

import pytest

from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.desk import Desk, Talker

PAIR = r"(?:[A-Z]\d?;-?\d+\.\d+;)"


class StrictClient:
    """Patterns over whole answers; nothing may be missing. One read of 512 bytes is an answer."""

    OPENED = re.compile(
        r"[0-9A-Fa-f]{2};[0-9A-Fa-f]{2};\d+,\d+;(?:[0-9A-Fa-f]{1,2},){6}[0-9A-Fa-f]{1,2};[^;]*;[^;]*;"
        r"(?P<model>[^;]*);[^;]*;[^;]*;\d+-\d+-\d+;[^;]*;[^;]*;[^;]*;\d+;[^;]*;(?P<tasks>\d+);"
    )
    STATE = re.compile(
        r"(?P<program>[^;]*);\d+;(?P<override>\d+);\d+;(?P<run>[0-9A-Fa-f]{2})(?P<stop>[0-9A-Fa-f]{2})(?P<error>\d+);"
        r"\d+;\d+;{8}[^;]*;\w+;\w+;\d+;\d+"
    )
    JOINTS = re.compile(rf"(?P<pairs>{PAIR}{{6,8}});\*{{4}},\*{{4}};\d+;-?\d+\.\d+;[0-9A-Fa-f]{{8}}")
    POSITION = re.compile(rf"(?P<pairs>{PAIR}{{6,8}});\d+,\d+;\d+;-?\d+\.\d+;[0-9A-Fa-f]{{8}}")

    def __init__(self, robot: Talker) -> None:
        self.robot = robot

    def ask(self, command: str, pattern: re.Pattern[str] | None = None) -> dict[str, str]:
        said = self.robot.send(f"1;1;{command}".encode())
        if not said:
            # The bare segment could go on: the pause behind it ends it.
            self.robot.session.idle()
            said = self.robot.answers()
        (answer,) = said
        text = self.robot.finish(answer)
        assert len(text) <= 512
        assert text[:3].upper() == "QOK"
        if pattern is None:
            return {}
        found = pattern.fullmatch(text[3:])
        assert found, text
        return found.groupdict()


@pytest.mark.parametrize("axes", [6, 8])
def test_a_client_with_strict_patterns_understands_every_answer(axes: int) -> None:
    robot = Desk(replace(QUIET, axis_pattern=axes)).client()
    client = StrictClient(robot)
    opened = client.ask("OPEN=USERTOOL", client.OPENED)
    assert (opened["model"], opened["tasks"]) == ("RH-3FRH5515-D", "8")
    client.ask("CNTLON")
    client.ask("OVRD=50")
    client.ask("SRVON")
    robot.desk.bench.advance(1.0)
    client.ask("EXECMOV (10,-20,5,30)")
    assert int(client.ask("STATE", client.STATE)["run"], 16) & 0x60 == 0x60
    robot.desk.bench.advance(5.0)
    state = client.ask("STATE", client.STATE)
    assert (state["program"], state["override"], state["error"]) == ("", "50", "0")
    joints = client.ask("JPOSF", client.JOINTS)["pairs"].split(";")
    assert joints[:8] == ["J1", "10.00", "J2", "-20.00", "J3", "5.00", "J4", "30.00"]
    assert len(joints) == 2 * axes + 1
    axes_reported = client.ask("PPOSF", client.POSITION)["pairs"].split(";")[:-1:2]
    assert axes_reported == ["X", "Y", "Z", "A", "B", "C", "L1", "L2"][:axes]
    client.ask("CNTLOFF")
    client.ask("CLOSE")


def test_a_native_four_axis_answer_is_none_for_that_client() -> None:
    """Section 1.11: that client finds no position in four pairs; this is why the axes can be chosen."""
    robot = Desk().client()
    assert StrictClient.JOINTS.fullmatch(robot.ask("JPOSF")[3:]) is None


class SegmentClient:
    """Sends bare segments, takes what comes, looks at three letters and splits at semicolons."""

    def __init__(self, robot: Talker) -> None:
        self.robot = robot

    def ask(self, command: str) -> str:
        said = self.robot.send(f"1;1;{command}".encode())
        if not said:
            assert self.robot.session.silence_s() is not None
            self.robot.session.idle()
            said = self.robot.answers()
        text = self.robot.finish(said[0])
        if text[:3] not in {"QoK", "Qok"}:
            raise ValueError(text[3:])
        return text[3:]


def test_a_client_of_bare_segments_works_with_six_axes() -> None:
    desk = Desk(replace(QUIET, axis_pattern=6))
    client = SegmentClient(desk.client())
    for command in ("OPEN=NARCUSER", "CNTLON", "EXECSPD M_NSPD", "EXECJOVRD M_NJOVRD", "EXECOVRD M_NOVRD"):
        client.ask(command)
    if float(client.ask("OVRD")) > 10.0:
        client.ask("OVRD=10.0")
    client.ask("SRVON")
    while int(client.ask("VALM_SVO").split("=")[1]) != 1:
        desk.bench.advance(0.1)
    client.ask("EXECDEF POS P1")
    with pytest.raises(ValueError, match="4350"):
        client.ask("EXECDEF POS P1")
    client.ask("EXECP1=(400.00,100.00,20.00,0.00,0.00,45.00)(4,0)")
    client.ask("EXECMVS P1")
    while float(client.ask("VALM_RSPD").split("=")[1]) > 0.0 or desk.bench.moving:
        desk.bench.advance(0.1)
    fields = client.ask("PPOSF").split(";")
    read = dict(zip(fields[:12:2], map(float, fields[1:12:2]), strict=True))
    assert read == {"X": 400.0, "Y": 100.0, "Z": 20.0, "A": 0.0, "B": 0.0, "C": 45.0}


def test_headerless_requests_line_feeds_and_lowercase_are_understood() -> None:
    robot = Desk(replace(QUIET, axis_pattern=6)).client("\r")

    def ask(line: str) -> str:
        (answer,) = robot.send(line.encode() + b"\n")
        text = robot.finish(answer)
        assert text.endswith("\r")
        return text[:-1]

    assert ask("1;1;OPEN=NARCUSR").startswith("QoK3F;3F;")
    assert ask("1;1;CNTLON") == "QoK"
    assert ask("1;1;EXECservo on") == "QoK"
    robot.desk.bench.advance(1.0)
    assert ask("1;1;EXECJCOSIROP = (10.0, -5.0, 3.0, 20.0, 0.0, 0.0)") == "QoK"
    assert ask("1;1;EXECmov jcosirop") == "QoK"
    robot.desk.bench.advance(5.0)
    assert ask("JPOS").startswith("QoKJ1;10.00;J2;-5.00;J3;3.00;J4;20.00;J5;0.00;J6;0.00;;****,****;100;")
    assert ask("PPOS").startswith("QoKX;")
    assert ask("1;1;EXECAccel 50,50") == "QoK"
    assert ask("1;1;EXECTORQ 1,80") == "QoK"
