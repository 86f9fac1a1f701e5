"""One recorded line of each message: what the models read they write again, key by key, in the same order."""

import json
from typing import Any

import pytest

from catseye.app.protocol.answers import Climbed, Opened, Welcome, answer_as, encode_answer
from catseye.app.protocol.commands import command_event_of, engine_line_of
from catseye.app.protocol.events import Unknown, encode_event, event_of
from catseye.app.protocol.message import MessageError
from catseye.app.protocol.requests import decode_request, encode_request
from catseye.app.protocol.run_events import Happened
from catseye.app.protocol.state import ControlState

_STAMP = '"v": 1, "t": "2026-11-21T09:44:55.012345+00:00"'
_RUN = f'{_STAMP}, "event": "%s", "run": "20261121T094455Z_open-loop_64469e"'
_IDLE = f'{_STAMP}, "event": "%s", "run": null'


def of_run(event: str, fields: str) -> str:
    return f"{{{_RUN % event}, {fields}}}"


def between_runs(event: str, fields: str) -> str:
    return f"{{{_IDLE % event}, {fields}}}"


CONFIRM = (
    '"id": "door", "kind": "confirm", "text": "Close the door.", "choices": [], "unit": "", "timeout_s": null, '
    '"task": null, "safe_answer": null, "motion": false'
)
MOTION = (
    '"id": "stage/1", "kind": "choice", "text": "Turn.", "choices": ["done", "skip"], "unit": "", "timeout_s": 60.0, '
    '"task": {"do": "turn-screw", "screw": "x", "turns": 0.5}, "safe_answer": "skip", "motion": true, '
    '"rests_after": ["skip"], "target": null, "override_percent": 20.0, "speed_deg_s": [80.0, 72.0, 300.0], '
    '"axes": [{"name": "J1", "unit": "deg"}]'
)
LIVE = (
    '"state": "EXECUTE", "data": {"name": "offset", "value": 0.43, "unit": "mm", "low": -0.1, '
    '"high": null, "accepted": false, "text": "turn clockwise"}'
)
BENCH = (
    '"cell": "lab-1", "simulated": true, "disk_free_bytes": 1000, "devices": [{"name": "robot", '
    '"endpoint": "tcp://127.0.0.1:10001", "driver": "melfa-r3", "moves_arm": true, "link": "ok", "identity": '
    '{"model": "RH-3FRH5515", "firmware": "A1", "serial": "17", "simulated": true}, "error": null, "age_s": 0.1}], '
    '"robot": {"joints": [1.0, null, 50.0, 0.0], "servo_on": true, "override_percent": null, '
    '"override_cap_percent": 20.0, "alarm_number": 0, "alarm_text": "", "emergency_stop": false, '
    '"teach_mode": false, "moving": false, "jogs": true, "age_s": 0.1}, '
    '"beam": {"signal": 0.8, "signal_native": "800 mV", "beam_ok": true, '
    '"beam_lost": false, "overspeed": false, "laser_ready": true, "displacement_mm": 1.5, "mean_mm": null, '
    '"spread_um": null, "age_s": 0.1}, "air": {"temperature_c": 20.0, "pressure_hpa": 1013.25, '
    '"humidity_percent": null, "refractive_index": null, "formula": "ciddor", "age_s": 2.0}, "door_closed": null, '
    '"layout": {"link1_mm": 325.0, "link2_mm": 225.0, "column_radius_mm": 100.0, "theta40_deg": 0.0, '
    '"limits_deg": {"j1": [-170.0, 170.0]}, "reflectors": [{"name": "P1", "x_mm": 1.0, "y_mm": 2.0, '
    '"facing_deg": 90.0, "field_half_angle_deg": 60.0}], "aim": "P1"}, '
    '"posture": {"joints_mm": [[0.0, 0.0, 0.0]], "heading_deg": 0.0, "limbs": [{"name": "arm", "start_mm": '
    '[0.0, 0.0, 0.0], "end_mm": [0.0, 0.0, 1.0], "radius_mm": 2.0}], "table_z_mm": -1.0}, '
    '"axes": [{"name": "J1", "unit": "deg", "low": -170.0, "high": 170.0}], "missed": 2'
)
EVENTS = [
    of_run("run-started", '"procedure": "open-loop", "title": "Open loop tracking \\u03b8"'),
    of_run("state", '"state": "EXECUTE", "reason": "devices are ready"'),
    between_runs("state", '"state": "STOPPED", "reason": "Ada (tui-1) cleared the abort"'),
    of_run("live", LIVE),
    of_run("first-motion", '"state": "EXECUTE", "data": {"stands": null, "way": [[0.0, 1.0]]}'),
    of_run("drives-left", '"state": "COMPLETE", "data": {"on": false, "text": "the drives are off"}'),
    of_run("happened", '"state": "EXECUTE", "kind": "zero", "data": {"number": 1, "dead_path_mm": 279.9}'),
    of_run("step-started", '"step": "seg/1", "title": "P1", "attempt": 2'),
    of_run("step-done", '"step": "seg/1", "title": "P1", "stored": true'),
    of_run("point", '"step": "seg/1", "point": {"displacement_mm": 1.25, "beam_ok": true, "note": null}'),
    of_run("prompt", CONFIRM),
    of_run("prompt", MOTION),
    of_run("answer", '"id": "door", "answer": "yes", "who": "Ada (tui-1)"'),
    of_run("warning", '"text": "weak", "data": {}'),
    of_run("warning", '"text": "SIMULATED", "data": {"simulated": true}'),
    of_run("warning", '"text": "u", "data": {"device": "umd", "more": [1, 2]}'),
    of_run("error", '"text": "no link", "exit_code": 3'),
    of_run(
        "progress",
        '"done": 1.0, "total": 4.0, "text": "P1", "elapsed_bench_s": 1.5, "left_bench_s": 3.0, '
        '"elapsed_s": 0.5, "left_s": 1.0, "changed": ""',
    ),
    of_run(
        "run-ended", '"status": "stopped", "exit_code": 130, "text": "x", "path": "runs/1", "drives_on": true'
    ),
    of_run(
        "control",
        '"what": "taken", "by": "Ada (tui-1)", "before": null, "holder": {"client": "tui-1", "who": "Ada"}',
    ),
    of_run("control", '"what": "lost", "by": null, "before": "Ada (tui-1)", "holder": null'),
    between_runs("clients", '"clients": [{"client": "tui-1", "who": "Ada"}]'),
    of_run(
        "client-lost",
        '"client": "tui-1", "who": "Ada", "reason": "it said nothing for 10 s", "policy": "hold"',
    ),
    between_runs("idle", '"state": "COMPLETE"'),
    '{"v": 1, "event": "dropped", "count": 7}',
    between_runs("drives", '"on": true, "off_at_utc": "2026-11-21T09:49:55+00:00"'),
    between_runs("drives", '"on": false, "reason": "the arm has rested for 300 s"'),
    between_runs("jog", '"on": true, "by": "Ada (tui-1)", "client": "tui-1", "percent": 5.0, "moving": "j1"'),
    between_runs(
        "jog",
        '"on": false, "by": "Ada (tui-1)", "client": "tui-1", "percent": null, "moving": null, "reason": "x"',
    ),
    between_runs("raw", '"device": "umd", "on": true, "by": "Ada (tui-1)", "client": "tui-1"'),
    between_runs("bench", BENCH),
    between_runs(
        "samples",
        '"quantity": "displacement_mm", "period_s": 0.02, "low": [1.0, null], "high": [2.0, null], "count": [3, 0], '
        '"missed": 0',
    ),
    between_runs(
        "wire",
        '"lines": [{"t": "now", "device": "umd", "dir": "rx", "hex": "00ff", "bytes": 300}], "missed": 1',
    ),
    between_runs("of-tomorrow", '"anything": {"goes": [1, null]}'),
]


def in_order(line: str) -> Any:
    """Return what a line says, fields in their order; blanks say nothing."""
    return json.loads(line, object_pairs_hook=list)


@pytest.mark.parametrize("line", EVENTS)
def test_an_event_is_written_as_it_was_read(line: str) -> None:
    # The version stands on the line, not in the event.
    message = json.loads(line)
    assert message.pop("v") == 1
    written = encode_event(event_of(message)).decode("ascii")
    assert written.endswith("\n")
    assert in_order(written) == in_order(line)


def test_only_an_event_of_tomorrow_is_unknown() -> None:
    unknown = [line for line in EVENTS if isinstance(event_of(json.loads(line)), Unknown)]
    assert [json.loads(line)["event"] for line in unknown] == ["of-tomorrow"]


REQUESTS = [
    '{"v": 1, "id": 1, "op": "hello", "client": "tui", "who": "Ada"}',
    '{"v": 1, "id": 1, "op": "control", "take": true, "force": false}',
    '{"v": 1, "id": 1, "op": "hand-over", "to": "tui-2"}',
    '{"v": 1, "id": "a", "op": "ladder"}',
    '{"v": 1, "id": "a", "op": "stop"}',
    '{"v": 1, "id": 1, "op": "answer", "prompt": "door", "text": "yes"}',
    '{"v": 1, "id": 1, "op": "override", "percent": 5.0}',
    (
        '{"v": 1, "id": 1, "op": "start", "procedure": "open-loop", "cell": null, "params": {"reflectors": ["P2"]}, '
        '"search": "auto", "arm": null, "speed": 1.0, "answers": null, "walk": false, "waive_walk": null, '
        '"keep_drives": false, "job": ""}'
    ),
    (
        '{"v": 1, "id": 1, "op": "resume", "run": "last", "arm": "lab-1", "answers": null, "waive_walk": null, '
        '"keep_drives": true}'
    ),
    '{"v": 1, "id": 1, "op": "watch", "on": true}',
    '{"v": 1, "id": 1, "op": "traffic", "on": false}',
    '{"v": 1, "id": 1, "op": "jog", "on": true, "percent": 5.0, "arm": null}',
    '{"v": 1, "id": 1, "op": "jog-step", "joint": "beam", "by": -0.5, "aim": "P1"}',
    '{"v": 1, "id": 1, "op": "jog-hold", "joint": "j4", "direction": -1}',
    '{"v": 1, "id": 1, "op": "walk-feed", "on": true}',
    '{"v": 1, "id": 1, "op": "raw", "device": "umd", "on": true, "arm": null}',
    '{"v": 1, "id": 1, "op": "send", "device": "umd", "hex": "610d"}',
]


@pytest.mark.parametrize("line", REQUESTS)
def test_a_request_is_written_as_it_was_read(line: str) -> None:
    assert encode_request(*decode_request(line.encode())).decode() == line + "\n"


@pytest.mark.parametrize("by", ["NaN", "Infinity", "-Infinity", "1e999", "90.01", "-90.01"])
def test_a_jog_by_no_number_of_degrees_is_refused(by: str) -> None:
    line = f'{{"v": 1, "id": 1, "op": "jog-step", "joint": "j1", "by": {by}}}'
    with pytest.raises(MessageError, match="by"):
        decode_request(line.encode())


SNAPSHOT = (
    '"engine": "catseye 1", "protocol": 1, "pid": 7, "you": "tui-1", "clients": [{"client": "tui-1", "who": "Ada"}], '
    '"control": {"client": "console", "who": "Ben"}, "on_client_lost": "stop", "run": null, "path": null, '
    '"procedure": null, "title": null, "simulated": null, "state": "ABORTED", "reason": null, "step": null, '
    '"prompt": null, "prompt_open_s": null, "progress": null, "live": null, "cell": "cell.toml", "runs": "runs", '
    '"aborted": "alarm", "drives": {"on": true, "off_at_utc": "soon"}, "jog": null'
)


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        (Welcome, f'{{"v": 1, "re": 1, "ok": true, "snapshot": {{{SNAPSHOT}}}}}'),
        (Climbed, '{"v": 1, "re": 1, "ok": true, "rung": "hold"}'),
        (Opened, '{"v": 1, "re": 1, "ok": true, "run": "1", "path": "runs/1"}'),
    ],
)
def test_an_answer_is_written_as_it_was_read(kind: type[Welcome | Climbed | Opened], line: str) -> None:
    assert encode_answer(1, answer_as(kind, json.loads(line))).decode() == line + "\n"


@pytest.mark.parametrize(
    "line",
    [
        '{"event": "engine-ready", "socket": "s", "runs": "r", "pid": 7}',
        '{"event": "opened", "run": "1", "path": "runs/1"}',
        '{"event": "ready"}',
        '{"event": "failed", "error": "no cell", "exit_code": 2}',
        '{"event": "ended", "error": "", "exit_code": 0}',
    ],
)
def test_engine_lines_round_trip(line: str) -> None:
    assert json.dumps(engine_line_of(json.loads(line)).json_object()) == line


@pytest.mark.parametrize(
    "line",
    [
        '{"kind": "progress", "title": "x", "share": 0.5, "elapsed_s": 1.0, "left_s": null, "text": "y"}',
        '{"kind": "warning", "text": "an estimate"}',
        '{"kind": "failed", "text": "no cell", "exit_code": 2}',
    ],
)
def test_command_reports_round_trip(line: str) -> None:
    assert json.dumps(command_event_of(json.loads(line)).json_object()) == line


def test_an_event_that_lacks_a_field_is_named() -> None:
    with pytest.raises(MessageError, match="run-ended: exit_code: Field required"):
        event_of({"event": "run-ended", "status": "complete", "text": "", "path": "x", "drives_on": False})


def test_tuples_of_a_procedure_become_lists() -> None:
    data: dict[str, Any] = {"place": (1.0, (2.0, None)), "rows": [{"at": (3,)}]}
    event = Happened(state=ControlState.EXECUTE, kind="seen", data=data)
    assert event.json_object()["data"] == {"place": [1.0, [2.0, None]], "rows": [{"at": [3]}]}


def test_text_that_is_no_unicode_is_escaped() -> None:
    event = event_of({"event": "warning", "text": "file \udc80", "t": "now", "run": None})
    assert b"file \\udc80" in encode_event(event)


def test_a_number_that_is_none_stays_one() -> None:
    event = event_of(
        {
            "event": "samples",
            "quantity": "displacement_mm",
            "period_s": 0.02,
            "low": [float("nan")],
            "high": [2.0],
            "count": [1],
            "missed": 0,
            "t": "now",
            "run": None,
        }
    )
    assert b'"low":[NaN]' in encode_event(event)
