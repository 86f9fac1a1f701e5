"""Which checks of the conformance suite apply to which driver."""

from dataclasses import replace
from typing import Any

import pytest

from catseye.app.testing.candidate import (
    Candidate,
    bytes_of,
    candidate_of,
    parse_setting,
    with_another_serial,
    without_mark,
)
from catseye.app.testing.checks.catalogue import ALL, applicable, not_applicable


def test_foreign_devices_skip_checks_needing_the_emulated_bench() -> None:
    foreign = candidate_of("line-counter", endpoint="tcp://192.0.2.1:4000")
    names = [check.name for check in applicable(foreign)]
    assert "a_stalled_device_times_out_and_is_healed" in names
    assert "a_lost_beam_is_latched_until_the_next_zero" not in names
    assert "--control URL" in not_applicable(foreign)["a_lost_beam_is_latched_until_the_next_zero"]


def test_a_control_port_makes_every_check_of_an_interferometer_apply() -> None:
    bench = candidate_of("line-counter", endpoint="tcp://192.0.2.1:4000", control="tcp://192.0.2.1:10099")
    assert set(not_applicable(bench)) == {"a_device_left_streaming_is_connected"}
    assert not bench.may_move


def test_a_control_port_without_an_endpoint_is_refused() -> None:
    with pytest.raises(ValueError, match="--endpoint"):
        candidate_of("line-counter", control="tcp://192.0.2.1:10099")


def test_a_serial_number_is_replaced_in_texts() -> None:
    assert with_another_serial(b"SN 00217\r\n", "00217") == b"SN 00210\r\n"
    wide = "SN 00210".encode("utf-16-le")
    assert with_another_serial(wide, "00210").decode("utf-16-le") == "SN 00211"
    assert with_another_serial(b"1 1", "1") == b"1 1"


def test_the_mark_of_an_emulator_is_replaced_in_texts() -> None:
    assert without_mark(b"ND Emulator") == b"ND HARDWARE"
    assert without_mark("EMULATOR".encode("utf-16-le")) == "HARDWARE".encode("utf-16-le")


def test_streaming_takes_escapes() -> None:
    assert bytes_of(r"R\r\x1b") == b"R\r\x1b"


def test_a_serial_link_cannot_be_spoilt() -> None:
    line = candidate_of("line-counter", endpoint="serial:///dev/ttyUSB0")
    assert "serial device server" in not_applicable(line)["a_dropped_connection_is_healed"]


def test_a_foreign_robot_is_moved_by_permission_only() -> None:
    robot = candidate_of("melfa-r3", endpoint="tcp://192.0.2.1:10001")
    assert not robot.may_move
    assert all("motion" not in check.needs for check in applicable(robot))
    assert "--allow-motion" in not_applicable(robot)["stop_ends_a_motion"]
    allowed = replace(robot, allow_motion=True)
    assert "stop_ends_a_motion" in [check.name for check in applicable(allowed)]
    moving = {"a_lost_answer_never_repeats_a_motion", "targets_beyond_the_limits_are_refused"}
    assert not moving & {check.name for check in applicable(allowed)}


def test_a_robot_has_the_arm_of_its_emulator_unless_named() -> None:
    arms = [candidate_of(name).arm for name in ("melfa-r3", "kuka-varproxy")]
    assert arms == ["rh-3frh5515", "kr210-r2700"]
    assert candidate_of("kuka-varproxy", endpoint="tcp://192.0.2.1:7000", arm="irb120").arm == "irb120"
    with pytest.raises(ValueError, match="no description"):
        candidate_of("kuka-varproxy", endpoint="tcp://192.0.2.1:7000", arm="kr3")


def test_a_candidate_has_the_role_of_its_class() -> None:
    roles = {
        name: candidate_of(name).role for name in ("melfa-r3", "line-counter", "modbus-air", "bench-tracker")
    }
    assert list(roles.values()) == ["robot", "interferometer", "environment", "tracker"]


def test_patience_follows_the_time_outs_of_questions() -> None:
    slow: Candidate = candidate_of("modbus-air", settings={"timeout_s": 7.0})
    assert slow.patience_s == 28.0
    assert candidate_of("melfa-r3").patience_s == 20.0


@pytest.mark.parametrize(
    ("text", "setting"),
    [
        ("timeout_s=0.5", ("timeout_s", 0.5)),
        ("profile=a.toml", ("profile", "a.toml")),
        ("terminator=", ("terminator", "")),
        ("deep={}", ("deep", {})),
    ],
)
def test_settings_are_json_or_text(text: str, setting: tuple[str, Any]) -> None:
    assert parse_setting(text) == setting


def test_every_check_says_what_it_asks() -> None:
    assert all((check.body.__doc__ or "").strip() for check in ALL)
