"""Analysis commands and their outputs: nothing that is read is overwritten, and no work is done for a lost output."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.errors import StorageError, UsageError

COMMANDS = {
    "identify": ["identify", "--points", "points.csv", "--cell", "cell.toml"],
    "predict": ["predict", "result.json", "--path", "points.csv"],
    "validate": ["validate", "result.json", "--measured", "points.csv"],
    "compensate": ["compensate", "result.json", "--path", "points.csv", "--cell", "cell.toml"],
    "design": ["design", "--cell", "cell.toml", "--path", "points.csv"],
    "resolution-model": ["resolution-model", "result.json"],
    "predict-resolution": ["predict-resolution", "points.csv", "--arm", "irb120", "--poses", "cell.toml"],
    "report": ["report", "result.json"],
    "dossier": ["dossier", "cell.toml"],
    "trend": ["trend", "cell.toml", "result.json"],
    "export": ["export", "result.json"],
}

READ = [
    (name, option, file)
    for name, words in COMMANDS.items()
    for option in (("-o", "--write-cell", "--write-commands") if name == "design" else ("-o",))
    for file in ("points.csv", "cell.toml", "result.json")
    if file in words
]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("points.csv", "cell.toml", "result.json"):
        (tmp_path / name).write_text("precious", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("name", "option", "file"), READ)
def test_a_file_that_is_read_is_not_overwritten(name: str, option: str, file: str, folder: Path) -> None:
    failure = CliRunner().invoke(cli, [*COMMANDS[name], option, f"./{file}"]).exception
    assert isinstance(failure, UsageError)
    assert file in str(failure)
    assert re.search("is a file that is read, and would be lost|is the result itself", str(failure))
    assert (folder / file).read_text(encoding="utf-8") == "precious"


@pytest.mark.parametrize("name", COMMANDS)
def test_an_unusable_output_path_fails_before_reading(name: str, folder: Path) -> None:
    failure = CliRunner().invoke(cli, [*COMMANDS[name], "-o", "missing/out.html"]).exception
    assert isinstance(failure, StorageError)
    assert "there is no folder missing; make it first" in str(failure)
    failure = CliRunner().invoke(cli, [*COMMANDS[name], "-o", str(folder)]).exception
    assert isinstance(failure, UsageError)
    assert "is a folder; give the name of a file to write" in str(failure)
