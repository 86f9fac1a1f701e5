"""The bench in words: units, ages, and what is wrong with its remedy."""

from typing import Any

import pytest

from catseye.app.protocol.bench import BenchStatus, RobotStatus
from catseye.app.protocol.run_events import ErrorReported
from catseye.app.tui.bench_text import (
    air_lines,
    alarm_text,
    beam_lines,
    device_line,
    device_text,
    engine_lines,
    length_text,
    robot_lines,
    troubles,
)
from catseye.app.tui.dialogs.error_dialog import split_remedy
from catseye.app.tui.engine_state import EngineState
from tests.unit.app.tui.scripted import snapshot_with
from tests.unit.app.tui.scripted_bench import bench, bench_status
from tests.unit.app.tui.serial.scripted_arm import arm_bench

ALARM: dict[str, Any] = {
    "alarm_number": 2165,
    "alarm_text": "alarm H2165: joint limit reached upwards, J5; jog the joint back, then reset the alarm",
}


def robot(**fields: Any) -> RobotStatus:
    found = bench_status(robot=fields).robot
    assert found is not None
    return found


def said(lines: list[Any]) -> str:
    return "\n".join(line.plain for line in lines)


def test_lengths_are_grouped_down_to_the_nanometre() -> None:
    assert length_text(743.1234564) == "743.123 456 mm"
    assert length_text(-0.00013) == "-0.000 130 mm"


def test_joints_and_nominal_place() -> None:
    text = said(robot_lines(bench_status(robot={"joints": [90.0, -90.0, 50.0, 12.3456]}), 0.0, roomy=False))
    assert "J1    90.000 deg" in text
    assert "J4    12.346 deg" in text
    # Link 1 along Y, link 2 along X.
    assert "X    225.000 mm    Y    325.000 mm" in text


@pytest.mark.parametrize(
    ("robot", "word"),
    [
        ({"servo_on": True, "moving": True}, "servo on · MOVES · 10 % (cap 20)"),
        ({"emergency_stop": True}, "✗ E-STOP pressed"),
        (ALARM, "✗ ALARM 2165"),
        ({"teach_mode": True}, "TEACH mode"),
        ({"machine_locked": True}, "no alarm · MACHINE LOCK"),
        ({"joints": None}, "joints not known"),
    ],
)
def test_state_of_the_robot(robot: dict[str, Any], word: str) -> None:
    assert word in said(robot_lines(bench_status(robot=robot), 0.0, roomy=False))


def test_what_the_controller_gives_no_number_for_is_a_dash() -> None:
    text = said(
        robot_lines(
            bench_status(robot={"override_percent": None, "joints": [20.0, None, 50.0, 0.0]}),
            0.0,
            roomy=False,
        )
    )
    assert "stands · — (cap 20)" in text
    assert "J2         — deg" in text
    assert "X " not in text


def test_what_is_old_says_so() -> None:
    shown = robot_lines(bench_status(), 7.0, roomy=False)
    assert "(7.1 s old)" in said(shown)
    assert any("dim" in str(span.style) for line in shown for span in line.spans)
    assert "old" not in said(robot_lines(bench_status(), 1.0, roomy=False))


def test_beam() -> None:
    text = said(beam_lines(bench_status(), 0.0))
    assert "BEAM OK → P1" in text
    assert "62 %" in text
    assert "743.123 456 mm" in text
    assert "σ 1.23 µm" in text
    lost = said(
        beam_lines(bench_status(beam={"beam_ok": False, "beam_lost": True, "displacement_mm": None}), 0.0)
    )
    assert "✗ NO BEAM" in lost
    assert "lost since the zero" in lost
    assert "displacement not known" in lost


def test_air() -> None:
    text = said(air_lines(bench_status(door_closed=False, disk_free_bytes=10_000_000), 0.0))
    assert "20.12 °C  1013.2 hPa  45.0 %RH" in text
    assert "n = 1.00027123  ciddor" in text
    assert "DOOR OPEN" in text
    assert "✗ disk" in text
    assert "n not known" in said(
        air_lines(bench_status(air={"refractive_index": None, "pressure_hpa": None}), 0.0)
    )


def test_nothing_known_is_said() -> None:
    assert said(robot_lines(None, 0.0, roomy=False)) == "no robot answers"
    assert said(beam_lines(None, 0.0)) == "no interferometer answers"
    assert "no air sensor answers" in said(air_lines(None, 0.0))


@pytest.mark.parametrize(
    ("cell", "remedy"),
    [("emulated-bench", "F10 starts the emulators again"), ("lab-1", "catseye emulate CELL")],
)
def test_emulators_that_do_not_run_are_pointed_to(cell: str, remedy: str) -> None:
    status = bench(cell=cell)
    for number, each in enumerate(status["devices"]):
        each.update(link="lost", error="refused", endpoint=f"tcp://127.0.0.1:{5000 + number}")
    found = troubles(BenchStatus.model_validate(status))
    assert found[0][0] == "emulators"
    assert remedy in found[0][1]
    status["devices"][0]["endpoint"] = "tcp://192.168.0.20:10001"
    assert "emulators" not in dict(troubles(BenchStatus.model_validate(status)))
    status["devices"][0].update(endpoint="tcp://127.0.0.1:5000", link="ok")
    assert "emulators" not in dict(troubles(BenchStatus.model_validate(status)))


def test_troubles_have_remedies() -> None:
    status = bench(
        robot={**ALARM, "emergency_stop": True},
        beam={"overspeed": True, "laser_ready": False},
        door_closed=False,
    )
    status["devices"][2]["error"] = "no answer within 1 s: check cable and power"
    found = troubles(BenchStatus.model_validate(status))
    names = [name for name, _ in found]
    assert names == ["robot", "robot", "door", "environment", "interferometer", "interferometer"]
    assert split_remedy(found[1][1])[1] == "jog the joint back, then reset the alarm (! resets it)"
    assert all(split_remedy(text)[1] for _, text in found)
    assert troubles(bench_status()) == []


def test_an_alarm_without_a_text_is_reported_by_its_number() -> None:
    assert "4711" in alarm_text(robot(alarm_number=4711))
    assert alarm_text(robot()) == ""


def test_device_in_a_line_and_in_full() -> None:
    device = (
        bench_status()
        .devices[0]
        .model_copy(update={"link": "lost", "error": "no answer: look at the cable", "age_s": 3.0})
    )
    line = device_line(device, 1.5).plain
    assert "✗ robot" in line
    assert "lost" in line
    assert "4.5 s" in line
    text = device_text(device, ALARM["alarm_text"], 1.5)
    for word in ("tcp://127.0.0.1:10001", "melfa-r3", "E-4711", "no answer: look at the cable", "H2165"):
        assert word in text
    unknown = device.model_copy(update={"identity": None, "age_s": None})
    assert "melfa-r3 at tcp://127.0.0.1:10001" in device_line(unknown, 0.0).plain
    assert "never" in device_line(unknown, 0.0).plain


def test_engine() -> None:
    engine = EngineState()
    engine.lost("no engine here: start one")
    assert said(engine_lines(engine, 3)) == "no engine here: start one"
    engine.met(snapshot_with(), 0.0)
    for number in range(5):
        fault = ErrorReported(text=f"fault {number}", exit_code=1)
        engine.take(fault.stamped("2026-11-21T09:00:00+00:00", None), 0.0)
    text = said(engine_lines(engine, 2))
    assert "Ada" in text
    assert "nobody" in text
    assert "09:00:00 fault 4" in text
    assert "fault 2" not in text


@pytest.mark.parametrize(("age_s", "old"), [(2.5, False), (5.5, False), (6.5, True)])
def test_air_is_old_after_three_looks_of_two_seconds(age_s: float, old: bool) -> None:
    assert ("old)" in air_lines(bench_status(air={"age_s": age_s}), 0.0)[1].plain) is old


@pytest.mark.parametrize(("age_s", "old"), [(1.5, False), (2.5, True)])
def test_beam_is_old_after_two_seconds(age_s: float, old: bool) -> None:
    lines = beam_lines(bench_status(beam={"age_s": age_s}), 0.0)
    assert any("old)" in line.plain for line in lines) is old


def test_a_device_that_the_cell_lacks_leads_to_set_up() -> None:
    status = bench_status(devices=[], beam=None, air=None)
    assert said(beam_lines(status, 0.0)) == "the cell has no interferometer: F10, 2"
    assert "the cell has no air sensor: F10, 2" in said(air_lines(status, 0.0))


# 30 mm x sin 1 deg.
ANGULAR = {"displacement_mm": 0.5235721931185038, "mean_mm": 0.5235721931185038, "spread_um": 0.5}


def test_angular_optics_are_read_in_degrees() -> None:
    text = said(beam_lines(bench_status(beam=ANGULAR), 0.0, 30.0))
    assert "1.000 000 deg" in text
    # 0.5e-3 mm / (30 mm cos 1 deg) rad = 9.5508e-4 deg.
    assert "σ 0.955 mdeg" in text
    assert "mm" not in text


def test_a_displacement_beyond_a_right_angle_is_no_angle() -> None:
    assert "angle not known" in said(beam_lines(bench_status(beam={"displacement_mm": 30.1}), 0.0, 30.0))


def test_torques_stand_beside_their_axes_where_there_is_room() -> None:
    status = BenchStatus.model_validate(arm_bench())
    assert status.robot is not None
    torques = (-12.34, 1043.0, -7.7, 0.1, None, 3.0)
    moved = status.model_copy(update={"robot": status.robot.model_copy(update={"torques_nm": torques})})
    roomy = [line.plain for line in robot_lines(moved, 0.0, roomy=True)]
    assert roomy[0].endswith("  -12.3 N m")
    assert roomy[1].endswith(" 1043.0 N m")
    assert "N m" not in roomy[4]
    assert {len(line) <= 36 for line in roomy[:6]} == {True}
    assert robot_lines(moved, 0.0, roomy=False)[-1].plain == "N m  -12 1043   -8    0    –    3"
    without = bench_status(robot={"joints": [0.0] * 4})
    assert "N m" not in said(robot_lines(without, 0.0, roomy=False))
