"""A validation path: what was measured, by itself and against a result that lies beside the runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.results.figures import Figure
from catseye.app.results.model import Section, Sign, Statement, section
from catseye.app.results.numbers import counted
from catseye.app.results.readiness.after_run import result_to_validate
from catseye.app.results.scara.figures import path as figures
from catseye.app.results.scara.figures.measured_path import (
    NO_RESULT,
    deviations_um,
    measured_path_figure,
)
from catseye.app.results.scara.identified_arm import arm_of, nominal_of
from catseye.app.results.scara.identify import aimed_bench
from catseye.app.results.scara.path_rows import holds_distances, path_measurement
from catseye.app.results.scara.path_view import gaps
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.validation import PathMeasurement, validate_on_path
from catseye.app.results.scara.validation_of_run import conventional_beside
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.procedures.scara.path.validation_path import ValidationPath
from catseye.procedures.scara.records import PathPosition

_COMPARED: Final = "catseye validate compares the run with a result"


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


def path_section(reader: RunReader) -> Section:
    """Return how far the arm was from a path, as far as no model is needed for that; nothing of another run."""
    rows = reader.rows(PathPosition.table) if reader.procedure == ValidationPath.name else []
    if not rows:
        return section("measured-path", "Path as measured", [])
    if holds_distances(rows):
        text = f"Measured along the path: {counted(len(rows), 'distance')}; {_COMPARED}."
        return section("measured-path", "Path as measured", [Statement(Sign.NEUTRAL, text)], brief=True)
    path = path_measurement(reader, 0.0)
    error_um, figure = deviations_um(path), measured_path_figure(path, _COMPARED)
    said = None if error_um is None else _deviation_statement(path, error_um)
    return section("measured-path", "Path as measured", [said, figure], brief=True)


def _deviation_statement(path: PathMeasurement, error_um: Floats) -> Statement:
    length_um = np.hypot(*error_um.T)
    rms_um, count = float(np.sqrt(np.nanmean(length_um**2))), int(np.isfinite(length_um).sum())
    passes = "" if path.arrivals == 1 else f", mean of {path.arrivals} passes"
    text = (
        f"Measured positions are {rms_um:.1f} µm rms (2D) from those of the path, {np.nanmax(length_um):.1f} µm at "
        f"most ({counted(count, 'position')}{passes}; the instrument's frame is fitted to them)."
    )
    return Statement(Sign.NEUTRAL, text, f"{rms_um:.1f} µm rms from the path")
