"""What a command reports on the descriptor of whoever started it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

from catseye.app.cli import event_channel
from catseye.app.cli.failure import write_failure
from catseye.app.cli.output import warn
from catseye.app.cli.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.protocol.channel import EVENTS_FD
from catseye.app.protocol.commands import (
    CommandEvent,
    CommandFailed,
    CommandProgress,
    CommandWarning,
    command_event_of,
)


class Starter:
    """Reads what the command reports."""

    def __init__(self, reading: int) -> None:
        self._reading = reading

    def heard(self) -> list[CommandEvent]:
        return [command_event_of(json.loads(line)) for line in os.read(self._reading, 65_536).splitlines()]


@pytest.fixture
def starter(monkeypatch: pytest.MonkeyPatch) -> Iterator[Starter]:
    reading, writing = os.pipe()
    monkeypatch.setattr(event_channel, "_descriptor", writing)
    yield Starter(reading)
    for descriptor in (reading, writing):
        os.close(descriptor)


def test_progress_is_reported_as_figures(starter: Starter) -> None:
    times_s = iter([0.0, 30.0])
    ProgressBar("bootstrap", lambda: next(times_s)).update(25.0, 100.0, "24 of 96")
    expected = CommandProgress(title="bootstrap", share=0.25, elapsed_s=30.0, left_s=90.0, text="24 of 96")
    assert starter.heard() == [expected]


def test_the_time_left_is_unknown_at_first(starter: Starter) -> None:
    times_s = iter([0.0, 1.0])
    ProgressBar("bootstrap", lambda: next(times_s)).update(0.0, 100.0, "")
    [progress] = starter.heard()
    assert isinstance(progress, CommandProgress)
    assert progress.left_s is None


def test_a_warning_is_read_and_reported(starter: Starter, capsys: pytest.CaptureFixture[str]) -> None:
    warn("an estimate")
    assert capsys.readouterr().err == "warning: an estimate\n"
    assert starter.heard() == [CommandWarning(text="an estimate")]


def test_a_failure_is_read_and_reported(starter: Starter, capsys: pytest.CaptureFixture[str]) -> None:
    assert write_failure(UsageError("no such cell")) == 2
    assert capsys.readouterr().err == "catseye: no such cell\n"
    assert starter.heard() == [CommandFailed(text="no such cell", exit_code=2)]


def test_a_starter_that_is_gone_disturbs_nobody(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    monkeypatch.setattr(event_channel, "_descriptor", writing)
    warn("an estimate")
    assert "an estimate" in capsys.readouterr().err
    os.close(writing)


def test_what_a_command_starts_does_not_report_for_it() -> None:
    reading, writing = os.pipe()
    program = (
        "import os; from catseye.app.cli.event_channel import open_channel; "
        f"open_channel(); print(os.environ.get({EVENTS_FD!r}))"
    )
    found = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, EVENTS_FD: str(writing)},
        pass_fds=[writing],
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout == "None\n"
    for descriptor in (reading, writing):
        os.close(descriptor)
