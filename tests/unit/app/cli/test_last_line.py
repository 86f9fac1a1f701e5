"""A stream of JSON lines says at its end how it ended, whatever went wrong on the way."""

import json
import sys
from pathlib import Path
from typing import Any, NoReturn, cast

import pytest

from catseye.app.cli import drive
from catseye.app.cli.detached_engine import detach
from catseye.app.cli.drive import conduct
from catseye.app.cli.hosting import DriveOptions
from catseye.app.cli.output import write_document
from catseye.app.cli.resume import resume
from catseye.app.errors import ConfigError
from catseye.app.protocol.requests import Start
from catseye.app.service.running import PlannedRun
from catseye.app.store.run_store import RunStore
from tests.unit.app.engine.fakes import ManualClock


def last_line(text: str) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(text.splitlines()[-1])
    return answer


def test_a_preparation_that_fails_after_a_line_ends_with_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    async def fails(*_: object) -> NoReturn:
        write_document("events", {"event": "run-started"})
        raise ConfigError("[robot] settings: wrong")

    monkeypatch.setattr(drive, "serve_and_run", fails)
    options = DriveOptions(None, None, 1.0, False, None, as_json=True)
    with pytest.raises(ConfigError):
        conduct(cast(PlannedRun, None), tmp_path, options, dry_run=False)
    answer = last_line(capsys.readouterr().out)
    assert (answer["error"], answer["exit_code"]) == ("[robot] settings: wrong", 2)


@pytest.mark.parametrize(
    ("said", "code"),
    [
        ("""echo '{"v": 1, "event": "failed", "error": "no such cell", "exit_code": 2}'; exit 2""", 2),
        ("echo broken >&2; exit 1", 1),
    ],
)
def test_a_detached_engine_that_fails_is_told_in_json(
    said: str,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    engine = tmp_path / "engine"
    engine.write_text(f"#!/bin/sh\ncat >/dev/null\n{said}\n")
    engine.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(engine))
    with pytest.raises(SystemExit) as ended:
        detach(Start(procedure="script"), tmp_path / "cell.toml", tmp_path, as_json=True)
    assert ended.value.code == code
    answer = last_line(capsys.readouterr().out)
    assert answer["exit_code"] == code
    assert answer["error"]


async def test_a_run_that_is_sealed_late_says_its_end(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = await RunStore.create(tmp_path, "open-loop", {}, ManualClock(), reserve_bytes=0)
    await made.event("drives", {"on": True, "text": "left on"})
    await made.event("run-ended", {"status": "complete", "exit_code": 0})
    await made.abandon()
    resume(str(made.path), runs=tmp_path, as_json=True)
    ended = last_line(capsys.readouterr().out)
    assert (ended["event"], ended["run"], ended["exit_code"]) == ("run-ended", made.path.name, 0)
    assert ended["drives_on"] is True
