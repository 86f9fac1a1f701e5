"""Results of motion resolution, as the screen Results lists and shows them; no widget in here."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from catseye.app.results.numbers import counted
from catseye.app.results.resolution.report_files import files_beside
from catseye.app.results.resolution.result import ResolutionResult
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.tui.report_kind import ReportKind, Words


def _row(result: ResolutionResult) -> tuple[str, str, str]:
    return "resolution", f"{counted(len(result.tests), 'test'):>10}", ""


def _heading(result: ResolutionResult) -> Sequence[str]:
    return result.arm, counted(len(result.tests), "test")


def _steps(path: Path, result: ResolutionResult) -> Sequence[tuple[str, Words]]:
    del result
    tables = "tables.csv"
    predict = ("predict-resolution", tables, "--arm", "ARM", "--poses", "POSES.csv", "-o", "predicted.json")
    return (
        (
            "look-up tables of the joints, from this and further results",
            ("resolution-model", str(path), "-o", tables),
        ),
        ("Cartesian least steps at poses of the arm", predict),
    )


def _files(path: Path, result: ResolutionResult) -> list[Path]:
    return [path, *files_beside(path, result.arm)]


KIND: Final = ReportKind(
    "resolution", ResolutionResult, _row, _heading, _steps, _files, resolution_files_report
)
