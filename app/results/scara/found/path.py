"""A validation path under way: what was measured so far, against a result that lies beside the runs."""

from collections.abc import Sequence
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.figures import Figure
from catseye.app.results.readiness.after_run import result_to_validate
from catseye.app.results.scara.figures import path as figures
from catseye.app.results.scara.figures.measured_path import NO_RESULT, measured_path_figure
from catseye.app.results.scara.identified_arm import arm_of, nominal_of
from catseye.app.results.scara.identify import aimed_bench
from catseye.app.results.scara.path_rows import holds_distances, path_measurement
from catseye.app.results.scara.path_view import gaps
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.validation import PathMeasurement, validate_on_path
from catseye.app.results.scara.validation_of_run import conventional_beside
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import CalibrationError
from catseye.procedures.scara.records import PathPosition


def drives_path(reader: RunReader) -> bool:
    """Return whether a run measures positions along a path."""
    rows = reader.rows(PathPosition.table)
    return bool(rows) and not holds_distances(rows)


def path_figures(reader: RunReader) -> tuple[Figure, ...]:
    """Return what was measured, and what the models beside the runs predict and leave of it."""
    path = path_measurement(reader, aimed_bench(reader, reader.path.parent).take_up_deg)
    results = _results(reader)
    why_not = NO_RESULT
    if results:
        try:
            return _compared(path, results)
        except (CalibrationError, UsageError) as error:
            why_not = str(error)
    figure = measured_path_figure(path, why_not)
    return () if figure is None else (figure,)


def _results(reader: RunReader) -> list[Result]:
    """Return the newest result of the run's cell beside the runs, before it the conventional model of its runs."""
    newest = result_to_validate(reader.name, reader.procedure, reader.path.parent)
    if newest is None:
        return []
    files: list[Path | None] = [conventional_beside(newest), newest]
    return [read_result(file) for file in files if file is not None]


def _compared(path: PathMeasurement, results: Sequence[Result]) -> tuple[Figure, ...]:
    """Return the comparison with the models.

    Raises:
        CalibrationError: too little of the path can be compared, as at its beginning.
        UsageError: a result lacks what a comparison takes.
    """
    arms = [arm_of(result) for result in results]
    validation = validate_on_path(path, arms, nominal_of(results[-1])[0])
    error_map = next((result for result in results if result.model == "error-map"), None)
    return tuple(figures.path_figures(validation, gaps(validation, error_map)))
