"""What is told of a job is not what is measured: it goes on where nobody reads."""

import json
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import TextIO

import pytest

from catseye.app.cli.campaign_teller import CampaignTeller
from catseye.app.protocol.campaign_events import StageStarted
from catseye.app.protocol.commands import CommandWarning
from catseye.app.protocol.run_events import WarningIssued
from tests.unit.app.cli.test_closed_pipe import closed_pipe

STARTED = StageStarted(
    t="", job="n1", stage="open-loop", number=1, count=2, attempt=1, command="catseye run open-loop"
)
WARNING = WarningIssued(text="the beam is weak")


@pytest.fixture
def unread() -> Iterator[TextIO]:
    stream = closed_pipe()
    yield stream
    with suppress(BrokenPipeError):
        stream.close()


def tell() -> None:
    teller = CampaignTeller(as_json=True)
    for _ in range(3):
        teller.say(STARTED)
        teller.told(WARNING)
        teller.heard(CommandWarning(text="the fit is poor"))


@pytest.mark.parametrize(
    ("left_s", "unknown", "said"),
    [
        (None, ("identify",), "time left, as earlier runs took: unknown"),
        (3905.0, (), "time left, as earlier runs took: 1 h 05 min"),
        (
            185.0,
            ("identify", "report"),
            "time left, as earlier runs took: 3 min 05 s, without identify, report",
        ),
    ],
)
def test_the_rest_of_a_job_is_told(
    left_s: float | None, unknown: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    event = STARTED.model_copy(update={"left_s": left_s, "unknown": unknown})
    CampaignTeller(as_json=False).say(event)
    assert capsys.readouterr().err.splitlines()[-1] == said


def test_a_job_goes_on_where_stdout_is_closed(unread: TextIO, capsys: pytest.CaptureFixture[str]) -> None:
    with redirect_stdout(unread):
        tell()
    talk = capsys.readouterr().err
    assert "stdout is closed; the job goes on" in talk
    assert talk.count("the beam is weak") == 3


def test_a_job_goes_on_where_stderr_is_closed(unread: TextIO, capsys: pytest.CaptureFixture[str]) -> None:
    with redirect_stderr(unread):
        tell()
    events = [json.loads(line)["event"] for line in capsys.readouterr().out.splitlines()]
    assert events == ["stage-started", "warning"] * 3


def test_a_job_goes_on_where_stdouts_disk_is_full(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full, redirect_stdout(full):
        tell()
        with suppress(OSError):
            full.flush()
    assert "the job goes on" in capsys.readouterr().err
