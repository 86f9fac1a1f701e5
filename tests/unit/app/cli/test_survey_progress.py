"""What `procedures --cell` says while it tries the plans of a cell."""

import io
import sys
from pathlib import Path

import pytest

from catseye.app.cell.templates import SCARA, TEMPLATES
from catseye.app.cli.procedures import procedures
from catseye.app.protocol.installed import procedure_names


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_survey_names_the_plan_that_it_tries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATES[SCARA].text, encoding="utf-8")
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    procedures(cell=cell, runs=tmp_path / "runs")
    for number, name in enumerate(procedure_names()):
        assert f"{number} of {len(procedure_names())} plans tried, {name} next" in screen.getvalue()


def test_a_file_has_no_line_of_each_plan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATES[SCARA].text, encoding="utf-8")
    procedures(cell=cell, runs=tmp_path / "runs")
    assert "plans tried" not in capsys.readouterr().err
