"""A stored validation path as a measurement: passes averaged."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from app.errors import UsageError
from app.store.reader import RunReader
from app.validation import PathMeasurement, established_rows
from calibration.points import Commands
from calibration.types import Floats


def path_measurement(reader: RunReader, take_up_deg: float) -> PathMeasurement:
    """Return the mean of all passes of a stored validation path.

    Args:
        reader: a run of validation-path.
        take_up_deg: travel after which a direction of approach holds.

    Raises:
        UsageError: the run holds no path, or its passes differ in length.
    """
    rows = reader.path_rows()
    if not rows:
        raise UsageError(f"{reader.path.name} holds no path; it takes a run of validation-path")
    passes: dict[int, list[Mapping[str, Any]]] = {}
    for row in rows:
        passes.setdefault(int(str(row.get("pass_number", 0))), []).append(row)
    whole = [one for one in passes.values() if len(one) == len(passes[min(passes)])]
    return _mean(whole, take_up_deg)


def _mean(passes: Sequence[Sequence[Mapping[str, Any]]], take_up_deg: float) -> PathMeasurement:
    first = passes[0]
    measured = np.stack(
        [np.stack([_column(p, "x_meas_mm"), _column(p, "y_meas_mm")], axis=1) for p in passes]
    )
    command = np.stack([_column(first, "x_mm"), _column(first, "y_mm")], axis=1)
    half = (len(first) + 1) // 2
    commands = Commands(
        np.deg2rad(_column(first, "theta1_deg")),
        np.deg2rad(_column(first, "theta2_deg")),
        _column(first, "direction1").astype(np.int64),
        _column(first, "direction2").astype(np.int64),
    )
    return PathMeasurement(
        commands=commands,
        command_mm=command,
        travel=np.where(np.arange(len(first)) < half, 1, -1).astype(np.int64),
        measured_mm=measured.mean(axis=0),
        u_mm=_column(first, "u_mm") / np.sqrt(len(passes)),
        established=established_rows(commands, float(np.deg2rad(take_up_deg))),
    )


def _column(rows: Sequence[Mapping[str, Any]], key: str) -> Floats:
    return np.array([float(row[key]) for row in rows])
