"""Positions from an instrument's file against the path that was driven: in order, in mm, and of this path."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.comparison import rigid_fit
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.mapping import LENGTHS
from catseye.procedures.scara.path.instrument_file import PositionsMapping, positions_in_plane
from catseye.procedures.scara.path.tracked_path import PathPoint
from catseye.procedures.scara.records import PathPosition

Floats = NDArray[np.float64]

_COMMAND_MM = 0.05
_COMMAND_DEG = 0.005
"""Commands in a file may be rounded by this."""

MEASURED_MM: Final = 5.0
"""No arm that is worth an error map stands farther from its command than this, frames aligned."""

_JOINTS = ("theta1_deg", "theta2_deg")
_DIRECTIONS = ("direction1", "direction2")
_PLACE = ("x_mm", "y_mm")
MEASURED_PLACE = ("x_meas_mm", "y_meas_mm")

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


def matched_positions(
    file: str,
    points: tuple[PathPoint, ...],
    passes: int,
    measured: Columns,
    mapping: PositionsMapping | None = None,
) -> list[PathPosition]:
    """Return the positions of a path from what a file holds.

    Args:
        file: its name, for complaints.
        points: commands of one pass.
        measured: rows of the file, in order.
        mapping: of a file that another program wrote, which holds no commands; None for one that does.

    Raises:
        TableFileError: another number of points, other commands, another unit, or places that are not those of
            this path; names the line.
    """
    if len(measured) != passes * len(points):
        raise TableFileError(
            f"{file}: holds {len(measured)} points and the path has {passes * len(points)} ({passes} pass(es) of "
            f"{len(points)}, there and back): every point that was driven needs a row, in the order of driving"
        )
    driven = points * passes
    if mapping is None:
        _require_command_units(file, driven, measured)
        _require_commands(file, driven, measured)
    else:
        measured = positions_in_plane(file, measured, mapping)
    require_places(file, _places(driven), measured, BY_HEADER if mapping is None else by_mapping(mapping))
    u_mm = measured["u_mm"].tolist() if "u_mm" in measured else [None] * len(measured)
    return [
        point.position(number // len(points), (x, y), u)
        for number, (point, (x, y), u) in enumerate(
            zip(driven, measured.stacked(MEASURED_PLACE).tolist(), u_mm, strict=True)
        )
    ]


def commands_as_measured(driven: Sequence[PathPoint]) -> Columns:
    """Return what an ideal instrument sees of an ideal arm, as its file would hold it."""
    place = _places(driven).T
    values = dict(zip((*_PLACE, *MEASURED_PLACE), (*place, *place), strict=True))
    return Columns(values, np.arange(2, len(driven) + 2))


def suspected_unit(expected: Floats, found: Floats, units: dict[float, str] = _LENGTHS) -> str | None:
    """Return the unit that values seem to have instead of the expected one; None when it is that one or unknown.

    Args:
        expected: values in the expected unit, shape (n, 2).
        found: values in an unknown unit, in a frame of their own, shape (n, 2).
        units: names by the factor between the spreads.
    """
    return _unit_of(_spread(found) / max(_spread(expected), 1e-12), units)


def _unit_of(ratio: float, units: Mapping[float, str]) -> str | None:
    return next((name for factor, name in units.items() if abs(ratio / factor - 1.0) <= _UNIT_SHARE), None)


def _require_command_units(file: str, driven: Sequence[PathPoint], measured: Columns) -> None:
    if _PLACE[0] in measured:
        unit, columns = suspected_unit(_places(driven), measured.stacked(_PLACE)), "x_mm, y_mm"
    else:
        wanted = np.array([[point.theta1_deg, point.theta2_deg] for point in driven])
        unit, columns = suspected_unit(wanted, measured.stacked(_JOINTS), _ANGLES), "theta1_deg, theta2_deg"
    if unit is not None:
        raise TableFileError(f"{file}: the commands in {columns} seem to be in {unit}: convert them")


def _require_commands(file: str, driven: Sequence[PathPoint], measured: Columns) -> None:
    fault = _cartesian_fault if _PLACE[0] in measured else _joint_fault
    for number, (point, line) in enumerate(zip(driven, measured.lines, strict=True), 1):
        if text := fault(point, measured, number - 1):
            given, expected = text
            raise TableFileError(
                f"{file}:{line}: the command is {given} and point {number} of this path is {expected}: the rows have "
                "to be those of this path, in the order of driving"
            )


def _cartesian_fault(point: PathPoint, measured: Columns, row: int) -> tuple[str, str] | None:
    """Return the command of a row and the one that was driven, if they differ."""
    given, wanted = [float(measured[name][row]) for name in _PLACE], (point.x_mm, point.y_mm)
    if _near(given, wanted, _COMMAND_MM):
        return None
    return f"({given[0]:g}, {given[1]:g}) mm", f"({wanted[0]:g}, {wanted[1]:g}) mm"


def _joint_fault(point: PathPoint, measured: Columns, row: int) -> tuple[str, str] | None:
    """Return the command of a row and the one that was driven, if they differ."""
    theta, wanted = [float(measured[name][row]) for name in _JOINTS], (point.theta1_deg, point.theta2_deg)
    directions = tuple(int(measured[name][row]) for name in _DIRECTIONS)
    driven = (point.direction1, point.direction2)
    if _near(theta, wanted, _COMMAND_DEG) and directions == driven:
        return None
    return (
        f"θ1 {theta[0]:g}°, θ2 {theta[1]:g}°, directions {directions}",
        f"θ1 {wanted[0]:.4f}°, θ2 {wanted[1]:.4f}°, directions {driven}",
    )


def _near(given: Sequence[float], wanted: Sequence[float], tolerance: float) -> bool:
    return max(abs(a - b) for a, b in zip(given, wanted, strict=True)) <= tolerance


@dataclass(frozen=True)
class Remedies:
    """What to do about positions that are read wrongly.

    Attributes:
        unit: where they are spread so many times as far as their commands; None where no unit explains it.
        exchanged: where they fit with x and y exchanged.
        other: where nothing is known of what is wrong.
    """

    unit: Callable[[float], str | None]
    exchanged: str
    other: str


def _other_unit(ratio: float) -> str | None:
    unit = _unit_of(ratio, _LENGTHS)
    return f"they seem to be in {unit}: convert them to mm" if unit else None


BY_HEADER: Final = Remedies(
    _other_unit,
    "exchange x_meas_mm and y_meas_mm",
    "it belongs to another point, or x and y are mixed up",
)
"""For a file whose header names the columns."""


def by_mapping(mapping: PositionsMapping) -> Remedies:
    """Return what to do about positions of a file that a mapping says how to read."""
    stated_mm = LENGTHS[mapping.columns.x_meas_mm.unit]
    worth = {stated_mm / mm: name for name, mm in LENGTHS.items()}

    def unit(ratio: float) -> str | None:
        found = _unit_of(ratio, worth)
        return f'they would fit with unit = "{found}" in the mapping' if found else None

    return Remedies(
        unit,
        "exchange the columns of x_meas_mm and y_meas_mm in the mapping, or set sign = -1 for one of them",
        "the mapping names other columns than those of x and y, or the rows are not in the order of driving, as in "
        "a list that is sorted by name",
    )


def require_places(file: str, commands_mm: Floats, measured: Columns, remedies: Remedies) -> None:
    """Refuse positions that cannot be those of a path.

    Args:
        commands_mm: positions, mm, shape (n, 2), not all in one place.
        measured: with x_meas_mm and y_meas_mm.

    Raises:
        TableFileError: another unit, a left-handed frame, another path; names the line.
    """
    fault = misplaced(commands_mm, measured.stacked(MEASURED_PLACE), remedies)
    if fault is not None:
        where = "" if fault.row is None else f":{measured.lines[fault.row]}"
        raise TableFileError(f"{file}{where}: {fault.text}")


@dataclass(frozen=True)
class Misplaced:
    """Why measured positions cannot be those of a path.

    Attributes:
        row: the worst one, None where all of them are concerned.
        text: what is wrong and what to do.
    """

    row: int | None
    text: str


def misplaced(commands_mm: Floats, places_mm: Floats, remedies: Remedies = BY_HEADER) -> Misplaced | None:
    """Return why measured positions cannot belong to commands: another unit, a left-handed frame, another path.

    Args:
        commands_mm: command positions, mm, shape (n, 2), not all in one place.
        places_mm: measured positions in a frame of their own, shape (n, 2).
    """
    ratio = _spread(places_mm) / _spread(commands_mm)
    if abs(ratio - 1.0) > _UNIT_SHARE:
        like = remedies.unit(ratio) or "they are not those of this path"
        return Misplaced(
            None, f"the measured positions are spread {ratio:.4g} times as far as the commands: {like}"
        )
    off = _off_mm(commands_mm, places_mm)
    worst = int(np.argmax(off))
    if off[worst] <= MEASURED_MM:
        return None
    if _off_mm(commands_mm, places_mm[:, ::-1]).max() <= MEASURED_MM:
        return Misplaced(
            None,
            "the measured positions fit their commands only with x and y exchanged: the columns are mixed up, or the "
            f"instrument's frame is left-handed; {remedies.exchanged}",
        )
    return Misplaced(
        worst,
        f"the measured position lies {off[worst]:.1f} mm from its command after the frames are aligned, more than "
        f"{MEASURED_MM:g} mm: {remedies.other}",
    )


def _off_mm(commands_mm: Floats, places_mm: Floats) -> Floats:
    """Return the distances of measured positions from their commands after a rigid alignment, mm, shape (n,)."""
    off = rigid_fit(places_mm, commands_mm).apply(places_mm) - commands_mm
    return np.asarray(np.hypot(*off.T), dtype=np.float64)


def _places(driven: Sequence[PathPoint]) -> Floats:
    return np.array([[point.x_mm, point.y_mm] for point in driven])


def _spread(values: Floats) -> float:
    """Return the rms distance from the mean."""
    # Numbers of a damaged file may be as large as any: neither their sum nor their square has to be a number.
    scale = max(float(np.abs(values).max()), 1.0)
    scaled = values / scale
    return scale * float(np.sqrt(np.mean(np.sum((scaled - scaled.mean(axis=0)) ** 2, axis=1))))
