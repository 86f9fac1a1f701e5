"""A command that is asked for JSON answers with JSON, whatever is wrong."""

import inspect
import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.cli.commands import COMMANDS
from catseye.app.cli.lazy import declaration_of
from catseye.app.cli.output import write_document
from catseye.app.errors import ConfigError

WITH_JSON = [
    name
    for name in COMMANDS
    if not isinstance(declared := declaration_of(name), typer.Typer)
    and "as_json" in inspect.signature(declared).parameters
]

WRONG = {
    "attach": ["nonsense"],
    "budget": ["nonsense", "--cell", "none.toml"],
    "calibrate": ["-o", "arm.json", "--poses", "none.csv", "--arm", "irb120"],
    "campaign": ["nonsense", "--cell", "none.toml"],
    "compare": ["none.json", "none.json"],
    "compensate": ["none.json", "--path", "none.csv", "-o", "out.csv"],
    "design": ["--cell", "none.toml"],
    "diagnose": ["nonsense"],
    "doctor": ["none.toml"],
    "dossier": ["none.toml", "-o", "dossier.html"],
    "identify": ["nonsense", "-o", "result.json"],
    "predict": ["none.json", "--path", "none.csv", "-o", "out.csv"],
    "prompts": ["nonsense"],
    "predict-resolution": ["none.csv", "--arm", "irb120", "--poses", "none.csv", "-o", "out.csv"],
    "procedures": ["--cell", "none.toml"],
    "reset-alarm": ["none.toml"],
    "resolution": ["nonsense", "-o", "out.json"],
    "resolution-model": ["none.json", "-o", "out.csv"],
    "resume": ["nonsense"],
    "run": ["nonsense", "--cell", "none.toml"],
    "select-poses": ["--arm", "nonsense", "--tool", "none.toml", "--count", "9", "-o", "out.csv"],
    "show": ["nonsense"],
    "trend": ["none.toml"],
    "validate": ["none.json", "--measured", "none.csv"],
    "verify": ["nonsense"],
}
"""Arguments of which something is missing, by command."""


def asked(*words: str) -> Result:
    return CliRunner().invoke(cli, [*words, "--json"])


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CATSEYE_RUNS", raising=False)


def test_every_command_with_json_has_a_wrong_call() -> None:
    assert set(WITH_JSON) - set(WRONG) == {"demo", "emulate", "runs", "terminal"} & set(WITH_JSON)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_arguments_are_answered_by_json(name: str) -> None:
    done = asked(name, *WRONG[name])
    assert done.exit_code != 0
    answer = json.loads(done.stdout)
    assert answer["error"]
    assert answer["exit_code"] == 2


@pytest.mark.parametrize(
    "words", [["validate"], ["nonsense"], ["show", "x", "--nonsense"], ["config", "show"]]
)
def test_usage_errors_are_answered_by_json(words: list[str]) -> None:
    done = asked(*words)
    answer = json.loads(done.stdout)
    assert (done.exit_code, answer["exit_code"]) == (2, 2)
    assert answer["error"].splitlines()[0] in done.stderr


def test_faults_of_a_cell_file_are_answered_once(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text("nonsense = 1\n", encoding="utf-8")
    (line,) = asked("config", "validate", "cell.toml").stdout.splitlines()
    assert json.loads(line)["valid"] is False


def test_without_json_nothing_comes_on_stdout() -> None:
    assert CliRunner().invoke(cli, ["show", "nonsense"]).stdout == ""


def test_an_answer_before_is_no_answer_now() -> None:
    write_document("detached", {"run": "another", "path": "/runs/another"})
    assert json.loads(asked("show", "nonsense").stdout)["exit_code"] == 2
    assert isinstance(asked("config", "show", "none.toml").exception, ConfigError)
