"""The result files that the screen Results lists, of every kind, and what is found beside them."""

from collections.abc import Callable, Sequence
from datetime import datetime
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias, cast

from catseye.app.errors import UsageError
from catseye.app.tui.session import DEMO_FOLDER

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.resolution.result import ResolutionResult
    from catseye.app.results.result_files import ResultFile, ResultFiles
    from catseye.app.results.scara.comparison import ResultComparison
    from catseye.app.results.scara.result import Result
    from catseye.app.results.serial_arm.result import SerialArmResult
    from catseye.app.tui.report_kind import ReportKind

    ScaraFile: TypeAlias = ResultFile[Result]
    AnyFile: TypeAlias = ResultFile[Result | ResolutionResult | SerialArmResult]
    AnyFiles: TypeAlias = ResultFiles[Result | ResolutionResult | SerialArmResult]

Version: TypeAlias = tuple[Path, datetime]

FILE_COLUMNS: Final = (
    ("", 2),
    ("result", 29),
    ("model", 13),
    ("distances", 10),
    ("rms µm", 8),
    (" sim", 5),
    ("written UTC", 12),
)
"""Titles and widths; `file_row` fills all but the first."""

_RUN_FOLDERS: Final = ("runs", "catseye-runs")


def shelf_of(root: Path) -> "AnyFiles":
    """Return the results beside the folder of runs and in the working folder; call it in a thread.

    What shows a result is imported here, too: that takes longer than a key may.
    """
    for module in ("catseye.app.tui.result_texts", "catseye.app.tui.widgets.figure_drawing"):
        import_module(module)
    from catseye.app.results.resolution.result import read_resolution
    from catseye.app.results.result_files import ResultFiles
    from catseye.app.results.scara.result import read_result
    from catseye.app.results.serial_arm.result import read_serial_arm

    folders = [root.absolute().parent, Path.cwd(), DEMO_FOLDER.absolute()]
    readers: dict[str, Callable[[Path], Result | ResolutionResult | SerialArmResult]] = {
        "catseye-result": read_result,
        "catseye-resolution": read_resolution,
        "catseye-serial-arm": read_serial_arm,
    }
    return ResultFiles(folders, readers)


@cache
def _kinds() -> "tuple[ReportKind, ...]":
    from catseye.app.tui.resolution import result_kind as resolution
    from catseye.app.tui.serial import result_kind as serial

    return resolution.KIND, serial.KIND


def report_kind(file: "AnyFile") -> "ReportKind | None":
    """Return how a result is shown by the sections of its report; None of a SCARA's, and of a file without any."""
    return next((kind for kind in _kinds() if isinstance(file.result, kind.holds)), None)


def as_scaras(file: "AnyFile") -> "ScaraFile | None":
    """Return a file that holds a SCARA's result; None for any other."""
    from catseye.app.results.scara.result import Result

    return cast("ScaraFile", file) if isinstance(file.result, Result) else None


def file_row(file: "AnyFile") -> list[str]:
    """Return what the row of a file says: name, model, distances or tests, rms, simulated, time."""
    from catseye.app.tui import result_texts

    if (kind := report_kind(file)) is not None:
        return kind.row_of(file)
    return result_texts.file_row(cast("ScaraFile", file))


def version_of(file: "AnyFile") -> Version:
    """Return what distinguishes a result from what is written over it later."""
    return file.path, file.changed_utc


def source_of(file: "ScaraFile", root: Path, cell: Path | None) -> list[str | Path]:
    """Return words that name the distances of a result and its budget; none where they are not found.

    Args:
        file: of the result.
        root: folder of all runs.
        cell: cell file; None while there is none.
    """
    names = [] if file.result is None else file.result.provenance.runs
    part = None if file.result is None else file.result.budget
    budget = [] if part is None or part.source == "run" else ["--budget", part.source]
    for folder in (root, *(file.path.parent / name for name in _RUN_FOLDERS)):
        if names and all((folder / name).is_dir() for name in names):
            return [*names, "--runs", folder, *budget]
    points = [file.path.parent / name for name in names]
    if len(points) == 1 and points[0].is_file() and cell is not None:
        return ["--points", points[0], "--cell", cell, *budget]
    return []


def compared(file: "ScaraFile", other: "AnyFile") -> "ResultComparison | str":
    """Return both results compared, or why they cannot be."""
    from catseye.app.results.scara.comparison import compare_results

    second = as_scaras(other)
    if file.result is None or second is None or second.result is None:
        return f"{other.path.name} is not a result that this one can be compared with. {other.fault}".strip()
    try:
        return compare_results(file.result, second.result)
    except UsageError as error:
        return str(error)


def scaras_of(files: "Sequence[AnyFile]") -> "list[ScaraFile]":
    """Return the files that hold a SCARA's result."""
    return [found for file in files if (found := as_scaras(file)) is not None]
