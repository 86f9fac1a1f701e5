"""A measured CSV as a path: states of approach, ways there and back, and what speaks against the numbers."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.measured_csv import read_measured_csv
from catseye.app.results.scara.path_csv import cartesian_commands, require_reach
from catseye.app.results.scara.path_start import against_start, start_text
from catseye.app.results.scara.validation import FEWEST_ROWS, TAKE_UP_DEG, PathMeasurement, established_rows
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.planar import Hand, forward
from catseye.calibration.scara.points import Commands
from catseye.procedures.kit.context import MeasuredPoint
from catseye.procedures.scara.path.measured_path import misplaced, uncertainty_fault

_ANGLE_UNITS = {"rad": 180.0 / np.pi, "mdeg": 1e-3}
"""What makes degrees of other units."""

_TELLING_MM = 50.0
"""Smaller paths fit commands in any unit of angles."""

_TURNS_BACK = -0.9
"""Cosine between steps of a path that turns back on itself."""


def measured_path(
    file: Path, nominal: tuple[float, float], hand: Hand, start: tuple[int, int]
) -> tuple[PathMeasurement, list[int], str]:
    """Return what a measured CSV holds, the line of each row, and what to know about its first row.

    Where a Cartesian path leaves its first row against the state that is said of it, nobody knows that state: the
    row is not compared.

    Args:
        file: the file.
        nominal: nominal links, mm.
        hand: of Cartesian commands.
        start: states of approach of the first Cartesian command.

    Raises:
        UsageError: the file is no measured CSV, holds too few rows, is in another unit, or belongs to another path.
    """
    measured = read_measured_csv(file)
    if len(measured) < FEWEST_ROWS:
        raise UsageError(
            f"{file}: holds {len(measured)} row(s); the frames are aligned by three unknowns, so that a comparison "
            f"takes {FEWEST_ROWS} positions or more, spread out"
        )
    commands, command_mm = _commands(file, measured, nominal, hand, start)
    places = np.array([[row.x_meas_mm, row.y_meas_mm] for row in measured])
    _require_places(file, measured, command_mm, places, nominal)
    established, text = established_rows(commands, float(np.deg2rad(TAKE_UP_DEG))), ""
    if measured[0].command_mm is not None:
        established &= ~against_start(commands).any(axis=1)
        text = start_text(commands)
    path = PathMeasurement(
        commands=commands,
        command_mm=command_mm,
        travel=travel_of(command_mm),
        measured_mm=places,
        u_mm=np.array([np.nan if row.u_mm is None else row.u_mm for row in measured]),
        established=established,
    )
    return path, [row.line for row in measured], text


def travel_of(command_mm: Floats) -> Ints:
    """Return 1 and −1 in turns, changing wherever a path turns back on itself, shape (n,).

    Args:
        command_mm: positions along the path, mm, shape (n, 2).
    """
    travel = np.ones(len(command_mm), dtype=np.int64)
    before, sign = np.zeros(2), 1
    for i, step in enumerate(np.diff(command_mm, axis=0), start=1):
        length = float(np.hypot(*step))
        if length > 0.0:
            if float(step @ before) / length < _TURNS_BACK:
                sign = -sign
            before = step / length
        travel[i] = sign
    return travel


def _commands(
    file: Path,
    measured: Sequence[MeasuredPoint],
    nominal: tuple[float, float],
    hand: Hand,
    start: tuple[int, int],
) -> tuple[Commands, Floats]:
    if measured[0].command_mm is not None:
        place = np.array([row.command_mm for row in measured])
        require_reach([row.line for row in measured], file, place, nominal, hand)
        return cartesian_commands(place, nominal, hand, start), place
    theta = _theta(measured)
    states = np.array([row.directions for row in measured], dtype=np.int64)
    commands = Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])
    return commands, forward(theta[:, 0], theta[:, 1], *nominal)


def _theta(measured: Sequence[MeasuredPoint]) -> Floats:
    return np.radians(np.array([row.theta_deg for row in measured], dtype=np.float64))


def _require_places(
    file: Path,
    measured: Sequence[MeasuredPoint],
    command_mm: Floats,
    places: Floats,
    nominal: tuple[float, float],
) -> None:
    for row in measured:
        if fault := uncertainty_fault(row.u_mm):
            raise UsageError(f"{file}:{row.line}: {fault}")
    if not np.any(np.ptp(command_mm, axis=0) > 1.0) or not np.any(np.ptp(places, axis=0) > 0.0):
        raise UsageError(
            f"{file}: all positions lie in one place, so the frames cannot be aligned: measure positions spread out"
        )
    wrong = misplaced(command_mm, places)
    if wrong is None:
        return
    if measured[0].theta_deg is not None and np.ptp(places, axis=0).max() > _TELLING_MM:
        for unit, factor in _ANGLE_UNITS.items():
            theta = factor * _theta(measured)
            if misplaced(forward(theta[:, 0], theta[:, 1], *nominal), places) is None:
                raise UsageError(
                    f"{file}: the commands in theta1_deg, theta2_deg seem to be in {unit}: convert them to degrees"
                )
    where = "" if wrong.row is None else f":{measured[wrong.row].line}"
    raise UsageError(f"{file}{where}: {wrong.text}")
