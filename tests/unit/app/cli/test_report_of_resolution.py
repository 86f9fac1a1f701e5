"""`catseye report` of results of motion resolution."""

from pathlib import Path

import pytest

from catseye.app.cli.report import report
from catseye.app.errors import UsageError
from catseye.app.results.resolution.result import ResolutionResult, write_resolution
from tests.unit.app.results.resolution.sample import backlash


def _written(tmp_path: Path, name: str) -> Path:
    path = tmp_path / name
    write_resolution(
        ResolutionResult.model_validate({"arm": "IRB 120", "tests": [backlash("A1", 0.0, valid=True)]}), path
    )
    return path


def test_the_kind_of_a_result_decides(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    report([str(_written(tmp_path, "one.json"))], page)
    text = page.read_text("utf-8")
    assert "Result one.json" in text
    assert "A1 at 0°: reversal error 0.0060°" in text


def test_several_results_make_one_page(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    report([str(_written(tmp_path, name)) for name in ("one.json", "two.json")], page)
    assert "Motion resolution of IRB 120" in page.read_text("utf-8")


def test_results_of_another_kind_are_reported_alone(tmp_path: Path) -> None:
    other = tmp_path / "other.json"
    other.write_text('{"format": "catseye-result/1"}', "utf-8")
    with pytest.raises(
        UsageError, match=r"other\.json: is of another kind.* takes those of motion resolution only"
    ):
        report([str(_written(tmp_path, "one.json")), str(other)], tmp_path / "page.html")


def test_a_report_is_of_one_run(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="name one run"):
        report(["first", "second"], tmp_path / "page.html")
