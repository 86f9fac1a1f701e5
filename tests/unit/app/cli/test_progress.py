"""Progress and narration as people see them."""

import json
import sys

import pytest

from catseye.app.cli.narrator import Narrator
from catseye.app.cli.progress import ProgressBar
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.run_events import (
    ErrorReported,
    PointMeasured,
    Progressed,
    PromptAsked,
    RunEnded,
    StateChanged,
    WarningIssued,
)
from catseye.app.protocol.state import ControlState


class Wall:
    """Real time that stands still until it is set."""

    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_time_left_follows_from_the_share_done(capsys: pytest.CaptureFixture[str]) -> None:
    wall = Wall()
    bar = ProgressBar("job", wall)
    wall.now_s = 130.0
    bar.update(1.0, 4.0, "first")
    said = capsys.readouterr().err
    assert " 25%" in said
    assert "30 s gone, 1 min 30 s left  first" in said


def test_a_file_gets_one_progress_line_per_tenth(capsys: pytest.CaptureFixture[str]) -> None:
    bar = ProgressBar("job", Wall())
    for done in range(1, 1001):
        bar.update(done, 1000.0, "x")
    bar.update(1000.0, 1000.0, "x")
    lines = capsys.readouterr().err.splitlines()
    assert 10 <= len(lines) <= 11
    assert all("\r" not in line for line in lines)
    assert "100%" in lines[-1]
    assert sum("100%" in line for line in lines) == 1


def test_a_terminal_gets_one_line_that_is_redrawn(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    wall = Wall()
    bar = ProgressBar("job", wall)
    bar.update(1.0, 2.0, "half")
    bar.update(1.1, 2.0, "too soon")
    wall.now_s += 1.0
    bar.update(2.0, 2.0, "all")
    bar.close()
    bar.close()
    said = capsys.readouterr().err
    assert said.count("\r") == 2
    assert "too soon" not in said
    assert "#" * 15 + "." * 15 in said
    assert said.endswith("all\n")


def test_a_total_of_nothing_is_done(capsys: pytest.CaptureFixture[str]) -> None:
    ProgressBar("job", Wall()).update(0.0, 0.0, "")
    assert "100%" in capsys.readouterr().err


def test_the_narrator_shows_where_an_error_happened(capsys: pytest.CaptureFixture[str]) -> None:
    trace = 'Traceback (most recent call last):\n  File "drift.py", line 3, in run\nAcmeError: upside down\n'
    Narrator("job", as_json=False).publish(ErrorReported(text="upside down", exit_code=70, trace=trace))
    assert capsys.readouterr().err == f"{trace}error: upside down\n"


def test_the_narrator_writes_for_people_on_stderr_only(capsys: pytest.CaptureFixture[str]) -> None:
    narrator = Narrator("job", as_json=False)
    narrator.publish(WarningIssued(text="the beam is weak"))
    narrator.publish(ErrorReported(text="no link", exit_code=3))
    narrator.publish(PromptAsked(id="go", kind="confirm", text="Close the door"))
    narrator.publish(StateChanged(state=ControlState.ABORTED, reason="alarm"))
    narrator.publish(StateChanged(state=ControlState.EXECUTE, reason="started"))
    narrator.publish(RunEnded(status="failed", exit_code=70, text="", path="runs/1", drives_on=False))
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == [
        "warning: the beam is weak",
        "error: no link",
        "question go: Close the door",
        "ABORTED: alarm",
        "run failed: runs/1",
    ]


def test_the_narrator_gives_programs_every_event_as_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    narrator = Narrator("job", as_json=True)
    events: list[AnyEvent] = [
        PointMeasured(step="θ1\n20°", point={}),
        Progressed(
            done=1.0, total=2.0, text="", elapsed_bench_s=1.0, left_bench_s=1.0, elapsed_s=1.0, left_s=1.0
        ),
    ]
    for event in events:
        narrator.publish(event)
    out = capsys.readouterr().out
    assert [json.loads(line) for line in out.splitlines()] == [
        {"format": "catseye-events/1", **event.json_object()} for event in events
    ]
