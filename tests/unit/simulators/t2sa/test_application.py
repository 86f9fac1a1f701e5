"""The emulated T2SA, line by line, as the sheet `trackers_ballbar` (section 5) has it."""

import re

import pytest

from tests.transcripts import t2sa
from tests.unit.simulators.trackers import Client, near, tracker_bench

STAMP = r"\d\d/\d\d/\d{4} \d\d:\d\d:\d\d (AM|PM)"


def client(**options: bool | float) -> Client:
    return Client(tracker_bench("t2sa", options=dict(options)))


def said(one: Client, line: str, wait_s: float = 0.0) -> str:
    """Return the answer to a line, at once or after a while."""
    answer = one.say(line.encode() + b"\r\n") or one.wait(wait_s)
    assert answer.endswith(b"\r\n")
    return answer.decode().removesuffix("\r\n")


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("!SET_SIM:0", "ACK-300 .*"),
        ("?STAT", "ACK-300 Instrument is connected"),
        ("?LSTA", "ACK-300 LON"),
        ("!LST:1", "ACK-300 Tracker Interface Started: True"),
        ("!LST:0", "ACK-300 .*"),
        ("!HALT", "ACK-300 READY"),
        ("!SET_REFERENCE_GROUP:base", "ACK-300 READY"),
        ("!SET_WORKING_FRAME:WORLD", "ACK-300 READY"),
        ("!PUBLISH_ALT_AZ_ROT:60;10;0.5", "ACK-300 .*"),
        ("!SAVE_SA_JOBFILE:C:\\job.xit64", "ACK-300 .*"),
        ("!RESET_T2SA", "ACK-300 .*"),
        ("!SET_MEAS_INDEX:7", "ACK-111 .*7.*"),
        ("!INC_MEAS_INDEX:2", "ACK-104 .*2"),
        ("!NONSENSE:1", "ERR-200 .*"),
        ("!MEAS_SINGLE_POINT:A;b", "ERR-200 .*"),
        ("!MEAS_SINGLE_POINT:A;b;other", "ERR-306 .*"),
        ("!SET_MEAS_INDEX:x", "ERR-200 .*"),
        ("?POS tool", "ERR-306 .*"),
        ("!SET_WORKING_FRAME:other", "ERR-314 .*"),
        ("!SAVE_SA_JOBFILE:/tmp/x", "ERR-316 .*"),
    ],
)
def test_commands_are_answered_as_the_sheet_has_it(line: str, answer: str) -> None:
    assert re.fullmatch(answer, said(client(), line))


@pytest.mark.parametrize("line", t2sa.SETTINGS)
def test_settings_of_the_public_client_are_taken(line: str) -> None:
    assert re.fullmatch("ACK-(300|104|111) .+", said(client(), line))


@pytest.mark.parametrize("line", ["SET_NUM_SAMPLES:x", "!SET_DRIFT_TOL:1", "!SET_LS_TOL:a;b", "!CLERCL:1"])
def test_settings_without_their_numbers_are_refused(line: str) -> None:
    assert said(client(), line).startswith("ERR-200 ")


@pytest.mark.parametrize("line", ["!CMDEXE:base", "!2FACE_CHECK:base", "!MEAS_DRIFT:base"])
def test_what_takes_time_is_busy_meanwhile(line: str) -> None:
    one = client()
    assert one.say(line.encode() + b"\r\n") == b""
    assert said(one, "?STAT") == "ERR-201 Command rejected. SA is busy."
    assert said(one, "!CMDEXE:base").startswith("ERR-201")
    assert one.wait(1.5) == b""
    assert re.fullmatch(
        rb"ACK-106 Successfully ran .* base\r\n", one.wait(1.0).replace(b" for base", b" base")
    )
    assert said(one, "?STAT") == "ACK-300 Instrument is connected"


def test_a_point_is_measured_and_remembered() -> None:
    one = client()
    line = said(one, "!MEAS_SINGLE_POINT:A;catseye;nest1", 2.0)
    found = re.fullmatch(rf"ACK-300 Single Point Measurement nest1 result (\S+) {STAMP} True", line)
    assert found is not None
    place = [float(value) for value in found[1].split(",")]
    assert place == pytest.approx(near(one.bench, "nest1"), abs=1e-5)
    assert said(one, "?POINT_POS:A;catseye;nest1").split(" result ")[1].startswith(found[1])
    said(one, "!MEAS_SINGLE_POINT:A;catseye;world1", 2.0)
    delta = said(one, "?POINT_DELTA:A;catseye;nest1;A;catseye;world1").split(" result ")[1].split(" ")[0]
    other = near(one.bench, "world1")
    assert [float(value) for value in delta.split(",")] == pytest.approx(
        [b - a for a, b in zip(place, other, strict=True)], abs=1e-5
    )


def test_a_report_has_six_values() -> None:
    one = client()
    said(one, "!CMDEXE:base", 3.0)
    number = r"-?\d+\.\d+"
    names = ";".join(f"{name}:{number}" for name in ("X", "Y", "Z", "Rx", "Ry", "Rz"))
    assert re.fullmatch(rf"ACK-300 Object Offset Report \w+;{names};{STAMP}", said(one, "?POS base"))
    assert "X:0.000000" in said(one, "?OFFSET:base;base")


def test_a_laser_warms_for_a_minute() -> None:
    one = client(laser_on=False)
    assert said(one, "?LSTA") == "ACK-300 LOFF"
    assert said(one, "!MEAS_SINGLE_POINT:A;catseye;nest1").startswith("ERR-200")
    said(one, "!LST:1")
    one.bench.bench.advance(20.0)
    assert said(one, "?LSTA") == "ACK-300 WARM, 40.00 seconds"
    one.bench.bench.advance(41.0)
    assert said(one, "?LSTA") == "ACK-300 LON"


def test_a_halt_ends_what_is_under_way() -> None:
    one = client()
    one.say(b"!CMDEXE:base\r\n")
    answer = one.say(b"!HALT\r\n") + one.wait(5.0)
    assert sorted(answer.split(b"\r\n")[:-1]) == [b"ACK-300 READY", b"ERR-330 Measurement halted"]
    assert said(one, "?STAT").startswith("ACK-300")


def test_after_a_shutdown_nothing_is_connected() -> None:
    one = client()
    said(one, "!LST:2")
    assert said(one, "?STAT").startswith("ERR-341")
    said(one, "!RESET_T2SA")
    assert said(one, "?STAT").startswith("ACK-300")


def test_lines_may_come_cut_and_joined() -> None:
    one = client()
    data = b"?STAT\r\n?LSTA\n"
    assert b"".join(one.say(bytes([byte])) for byte in data) == one.say(data)
