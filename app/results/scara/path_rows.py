"""A stored validation path as a measurement: positions averaged over passes, or distances."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.results.scara.distance_validation import DistancePath
from catseye.app.results.scara.measured import travel_of
from catseye.app.results.scara.points import point_columns, to_points
from catseye.app.results.scara.validation import PathMeasurement, established_rows
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.points import Commands
from catseye.procedures.scara.records import PathPosition


def path_measurement(reader: RunReader, take_up_deg: float) -> PathMeasurement:
    """Return the mean of all passes of a stored validation path.

    Args:
        take_up_deg: travel after which a direction of approach holds.

    Raises:
        UsageError: the run holds no path, or distances along one.
    """
    rows = _rows(reader)
    if holds_distances(rows):
        raise UsageError(
            f"{reader.path.name} holds distances along a path, not positions: it was measured with "
            "instrument=interferometer"
        )
    passes: dict[int, list[Mapping[str, Any]]] = {}
    for row in rows:
        passes.setdefault(int(str(row.get("pass_number", 0))), []).append(row)
    whole = [one for one in passes.values() if len(one) == len(passes[min(passes)])]
    return _mean(whole, take_up_deg)


def distance_path(reader: RunReader, take_up_deg: float) -> DistancePath:
    """Return the distances of a stored validation path, all passes.

    Args:
        reader: a run of validation-path that was measured by the interferometer.
        take_up_deg: travel after which a direction of approach holds.

    Raises:
        UsageError: the run holds no path, or positions along one.
    """
    rows = _rows(reader)
    if not holds_distances(rows):
        raise UsageError(
            f"{reader.path.name} holds positions along a path, not distances: an independent instrument measured it"
        )
    columns = point_columns(rows)
    points = to_points(columns, columns.names)
    established = _established(rows, points.commands, float(np.deg2rad(take_up_deg)))
    return DistancePath(points, _command_mm(rows), _travel(rows), established, _stretch_of(rows))


def holds_distances(rows: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether the rows of a path are distances; otherwise they are positions."""
    return bool(rows) and rows[0].get("displacement_mm") is not None


def _rows(reader: RunReader) -> list[dict[str, Any]]:
    rows = reader.rows(PathPosition.table)
    if not rows:
        raise UsageError(f"{reader.path.name} holds no path; it takes a run of validation-path")
    return list(rows)


def _commands(rows: Sequence[Mapping[str, Any]]) -> Commands:
    return Commands(
        np.deg2rad(_column(rows, "theta1_deg")),
        np.deg2rad(_column(rows, "theta2_deg")),
        _column(rows, "direction1").astype(np.int64),
        _column(rows, "direction2").astype(np.int64),
    )


def _command_mm(rows: Sequence[Mapping[str, Any]]) -> Floats:
    return np.stack([_column(rows, "x_mm"), _column(rows, "y_mm")], axis=1)


def _established(rows: Sequence[Mapping[str, Any]], commands: Commands, take_up_rad: float) -> Bools:
    """Return where a direction of approach holds; each line of each pass begins with a take-up of its own."""
    return established_rows(commands, take_up_rad, _stretch_of(rows))


def _lines(rows: Sequence[Mapping[str, Any]]) -> Ints | None:
    """Return the number of the line that each row belongs to; None for a path that names none."""
    numbers = [row.get("line") for row in rows]
    return None if None in numbers else np.array(numbers, dtype=np.int64)


def _stretch_of(rows: Sequence[Mapping[str, Any]]) -> Ints:
    """Return the place, from 0, of the line of a pass that each row belongs to."""
    keys = [(row.get("pass_number", 0), row.get("line")) for row in rows]
    return np.cumsum([0, *(before != after for before, after in pairwise(keys))])


def _travel(rows: Sequence[Mapping[str, Any]]) -> Ints:
    """Return 1 on the way there and -1 on the way back; points may be missing, so the ends distinguish them.

    A path that a file gives need not come back to where it began: it turns where it turns back on itself.
    """
    travel = np.ones(len(rows), dtype=np.int64)
    pass_number, place = _column(rows, "pass_number"), _command_mm(rows)
    if _lines(rows) is not None:
        return travel_of(place, _stretch_of(rows))
    for number in np.unique(pass_number):
        own = np.flatnonzero(pass_number == number)
        farthest = int(np.argmax(np.hypot(*(place[own] - place[own[0]]).T)))
        travel[own[farthest + 1 :]] = -1
    return travel


def _mean(passes: Sequence[Sequence[Mapping[str, Any]]], take_up_deg: float) -> PathMeasurement:
    first = passes[0]
    measured = np.stack(
        [np.stack([_column(p, "x_meas_mm"), _column(p, "y_meas_mm")], axis=1) for p in passes]
    )
    commands = _commands(first)
    take_up_rad = float(np.deg2rad(take_up_deg))
    return PathMeasurement(
        commands=commands,
        command_mm=_command_mm(first),
        travel=_travel(first),
        measured_mm=measured.mean(axis=0),
        # Passes do not make it smaller: most of it is the same in each of them.
        u_mm=np.mean([_column(p, "u_mm") for p in passes], axis=0),
        established=_established(first, commands, take_up_rad),
        arrivals=len(passes),
        numbers=_lines(first),
    )


def _column(rows: Sequence[Mapping[str, Any]], key: str) -> Floats:
    return np.array([np.nan if row[key] is None else float(row[key]) for row in rows])
