"""The files that a report of motion resolution is made from, told apart by what they hold."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.errors import UsageError
from catseye.app.results.resolution.joint_tables import TablesFile, read_joint_tables
from catseye.app.results.resolution.predicted import PREDICTED_FORMAT, PredictedResolution, read_predicted
from catseye.app.results.resolution.result import RESOLUTION_FORMAT, ResolutionResult, read_resolution
from catseye.app.results.result_file import format_of

_FORMATS: Final = frozenset({RESOLUTION_FORMAT, PREDICTED_FORMAT})


@dataclass(frozen=True)
class ReportFiles:
    """What a report shows.

    Attributes:
        results: of tests, at least one.
        predicted: predictions for the tool.
        tables: of the joints' models; None without.
    """

    results: tuple[ResolutionResult, ...]
    predicted: tuple[PredictedResolution, ...] = ()
    tables: TablesFile | None = None


def is_of_resolution(path: Path) -> bool:
    """Return whether a file belongs to motion resolution: a result, a prediction, or look-up tables."""
    return _is_tables(path) or format_of(path) in _FORMATS


def read_report_files(paths: Sequence[Path]) -> ReportFiles:
    """Read results, predictions and tables, all of one arm.

    Raises:
        UsageError: a file is missing or wrong, there is no result, they are of several arms, or there are two tables.
    """
    tables = [path for path in paths if _is_tables(path)]
    documents = [path for path in paths if path not in tables]
    predicted = [path for path in documents if format_of(path) == PREDICTED_FORMAT]
    results = [read_resolution(path) for path in documents if path not in predicted]
    if not results:
        raise UsageError(
            "tables and predictions are shown beside measured steps: name a result of catseye resolution, too"
        )
    if len(tables) > 1:
        raise UsageError(
            f"{', '.join(map(str, tables))}: a report shows one set of tables: make them of all results"
        )
    predictions = [read_predicted(path) for path in predicted]
    arms = list(dict.fromkeys([*(one.arm for one in results), *(one.arm for one in predictions)]))
    if len(arms) > 1:
        named = ", ".join(path.name for path in paths)
        raise UsageError(
            f"{named}: the files are of several arms: {', '.join(arms):.200}; make a report of each"
        )
    return ReportFiles(
        tuple(results),
        tuple(predictions),
        read_joint_tables(tables[0], _joints(results)) if tables else None,
    )


def files_beside(result: Path, arm: str) -> list[Path]:
    """Return the predictions for an arm in the folder of a result, and the look-up tables that they name."""
    found: dict[Path, str] = {}
    for path in sorted(result.parent.glob("*.json")):
        try:
            if format_of(path) == PREDICTED_FORMAT and (predicted := read_predicted(path)).arm == arm:
                found[path] = predicted.tables
        except UsageError:
            # A prediction that cannot be read says nothing against the result.
            continue
    tables = {result.parent / Path(name).name for name in found.values()}
    return [*found, *(tables if len(tables) == 1 and all(path.is_file() for path in tables) else ())]


def _is_tables(path: Path) -> bool:
    return path.suffix.lower() == ".csv"


def _joints(results: Sequence[ResolutionResult]) -> list[str]:
    """Return the joints that results name; the arm's description need not be at hand."""
    described = [one.joint for result in results for one in result.actuation]
    return list(dict.fromkeys([*described, *(test.joint for result in results for test in result.tests)]))
