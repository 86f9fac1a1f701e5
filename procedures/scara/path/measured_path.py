"""Positions from an instrument's file against the path that was driven: in order, in mm, and of this path."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.comparison import rigid_fit
from catseye.procedures.kit.context import MeasuredPoint
from catseye.procedures.kit.errors import MeasuredFileError
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.path.tracked_path import PathPoint

Floats = NDArray[np.float64]

_COMMAND_MM = 0.05
_COMMAND_DEG = 0.005
"""Commands in a file may be rounded by this."""

_MEASURED_MM = 5.0
"""No arm that is worth an error map stands farther from its command than this, frames aligned."""

_LARGEST_U_MM = 1.0
"""An instrument with a larger uncertainty would tell nothing about an error map: such numbers are µm."""

_LENGTHS = {
    1e3: "µm",
    1e-3: "m",
    0.1: "cm",
    1.0 / 25.4: "inches",
    25.4: "mm taken for inches and converted once too often",
}
_ANGLES = {float(np.pi / 180.0): "rad", 1e3: "mdeg", float(180.0 / np.pi): "deg taken for rad and converted"}

_UNIT_SHARE = 0.05
"""A ratio of spreads this near to a factor gives the unit away."""


def matched_rows(
    file: str, points: tuple[PathPoint, ...], passes: int, measured: Sequence[MeasuredPoint]
) -> list[Row]:
    """Return the rows of a path from what a file holds.

    Args:
        file: its name, for complaints.
        points: commands of one pass.
        passes: how often the path was driven.
        measured: rows of the file, in order.

    Raises:
        MeasuredFileError: another number of points, other commands, another unit, or places that are not those of
            this path; names the line.
    """
    if len(measured) != passes * len(points):
        raise MeasuredFileError(
            f"{file}: holds {len(measured)} points and the path has {passes * len(points)} ({passes} pass(es) of "
            f"{len(points)}, there and back): every point that was driven needs a row, in the order of driving"
        )
    driven = points * passes
    _require_command_units(file, driven, measured)
    for number, (point, row) in enumerate(zip(driven, measured, strict=True), 1):
        _require_command(file, number, point, row)
    _require_places(file, driven, measured)
    _require_uncertainties(file, measured)
    return [
        {
            **point.as_row(),
            "x_meas_mm": row.x_meas_mm,
            "y_meas_mm": row.y_meas_mm,
            "u_mm": row.u_mm,
            "pass_number": number // len(points),
        }
        for number, (point, row) in enumerate(zip(driven, measured, strict=True))
    ]


def suspected_unit(expected: Floats, found: Floats, units: dict[float, str] = _LENGTHS) -> str | None:
    """Return the unit that values seem to have instead of the expected one; None when it is that one or unknown.

    Args:
        expected: values in the expected unit, shape (n, 2).
        found: values in an unknown unit, in a frame of their own, shape (n, 2).
        units: names by the factor between the spreads.
    """
    ratio = _spread(found) / max(_spread(expected), 1e-12)
    return next((name for factor, name in units.items() if abs(ratio / factor - 1.0) <= _UNIT_SHARE), None)


def _require_command_units(file: str, driven: Sequence[PathPoint], measured: Sequence[MeasuredPoint]) -> None:
    if measured[0].command_mm is not None:
        given = np.array([row.command_mm for row in measured])
        unit, columns = suspected_unit(_places(driven), given), "x_mm, y_mm"
    else:
        given = np.array([row.theta_deg for row in measured])
        wanted = np.array([[point.theta1_deg, point.theta2_deg] for point in driven])
        unit, columns = suspected_unit(wanted, given, _ANGLES), "theta1_deg, theta2_deg"
    if unit is not None:
        raise MeasuredFileError(f"{file}: the commands in {columns} seem to be in {unit}: convert them")


def _require_command(file: str, number: int, point: PathPoint, row: MeasuredPoint) -> None:
    if row.command_mm is not None:
        wanted = (point.x_mm, point.y_mm)
        fits = max(abs(a - b) for a, b in zip(row.command_mm, wanted, strict=True)) <= _COMMAND_MM
        given = f"({row.command_mm[0]:g}, {row.command_mm[1]:g}) mm"
        expected = f"({wanted[0]:g}, {wanted[1]:g}) mm"
    else:
        theta, directions = row.theta_deg or (np.nan, np.nan), row.directions
        wanted = (point.theta1_deg, point.theta2_deg)
        near = max(abs(a - b) for a, b in zip(theta, wanted, strict=True)) <= _COMMAND_DEG
        fits = near and directions == (point.direction1, point.direction2)
        given = f"θ1 {theta[0]:g}°, θ2 {theta[1]:g}°, directions {directions}"
        expected = (
            f"θ1 {wanted[0]:.4f}°, θ2 {wanted[1]:.4f}°, directions {(point.direction1, point.direction2)}"
        )
    if not fits:
        raise MeasuredFileError(
            f"{file}:{row.line}: the command is {given} and point {number} of this path is {expected}: the rows have "
            "to be those of this path, in the order of driving"
        )


def _require_places(file: str, driven: Sequence[PathPoint], measured: Sequence[MeasuredPoint]) -> None:
    places = np.array([[row.x_meas_mm, row.y_meas_mm] for row in measured])
    fault = misplaced(_places(driven), places)
    if fault is not None:
        where = "" if fault.row is None else f":{measured[fault.row].line}"
        raise MeasuredFileError(f"{file}{where}: {fault.text}")


@dataclass(frozen=True)
class Misplaced:
    """Why measured positions cannot be those of a path.

    Attributes:
        row: the worst one, None where all of them are concerned.
        text: what is wrong and what to do.
    """

    row: int | None
    text: str


def misplaced(commands_mm: Floats, places_mm: Floats) -> Misplaced | None:
    """Return why measured positions cannot belong to commands: another unit, a left-handed frame, another path.

    Args:
        commands_mm: command positions, mm, shape (n, 2), not all in one place.
        places_mm: measured positions in a frame of their own, shape (n, 2).
    """
    ratio = _spread(places_mm) / _spread(commands_mm)
    if abs(ratio - 1.0) > _UNIT_SHARE:
        unit = suspected_unit(commands_mm, places_mm)
        like = f"they seem to be in {unit}: convert them to mm" if unit else "they are not those of this path"
        return Misplaced(
            None, f"the measured positions are spread {ratio:.4g} times as far as the commands: {like}"
        )
    off = _off_mm(commands_mm, places_mm)
    worst = int(np.argmax(off))
    if off[worst] <= _MEASURED_MM:
        return None
    if _off_mm(commands_mm, places_mm[:, ::-1]).max() <= _MEASURED_MM:
        return Misplaced(
            None,
            "the measured positions fit their commands only with x and y exchanged: the columns are mixed up, or the "
            "instrument's frame is left-handed; exchange x_meas_mm and y_meas_mm",
        )
    return Misplaced(
        worst,
        f"the measured position lies {off[worst]:.1f} mm from its command after the frames are aligned, more than "
        f"{_MEASURED_MM:g} mm: it belongs to another point, or x and y are mixed up",
    )


def _off_mm(commands_mm: Floats, places_mm: Floats) -> Floats:
    """Return the distances of measured positions from their commands after a rigid alignment, mm, shape (n,)."""
    off = rigid_fit(places_mm, commands_mm).apply(places_mm) - commands_mm
    return np.asarray(np.hypot(*off.T), dtype=np.float64)


def _require_uncertainties(file: str, measured: Sequence[MeasuredPoint]) -> None:
    for row in measured:
        if fault := uncertainty_fault(row.u_mm):
            raise MeasuredFileError(f"{file}:{row.line}: {fault}")


def uncertainty_fault(u_mm: float | None) -> str:
    """Return what is wrong with a stated standard uncertainty; empty when nothing is."""
    if u_mm is None or u_mm <= _LARGEST_U_MM:
        return ""
    return (
        f"u_mm = {u_mm:g} is more than {_LARGEST_U_MM:g} mm: it seems to be in µm; convert it to mm, or leave the "
        "column out"
    )


def _places(driven: Sequence[PathPoint]) -> Floats:
    return np.array([[point.x_mm, point.y_mm] for point in driven])


def _spread(values: Floats) -> float:
    """Return the rms distance from the mean."""
    return float(np.sqrt(np.mean(np.sum((values - values.mean(axis=0)) ** 2, axis=1))))
