"""Predicted CSV: a path with where the model says the arm really goes (version 1)."""

from pathlib import Path

import numpy as np

from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import csv_text
from catseye.app.results.scara.path_csv import CommandPath
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.prediction import Prediction

ADDED = ("x_pred_mm", "y_pred_mm", "ex_um", "ey_um", "u_ex_um", "u_ey_um")

_DECIMALS = (6, 6, 3, 3, 3, 3)
"""A nanometre throughout."""


def write_predicted_csv(path: CommandPath, prediction: Prediction, output: Path) -> None:
    """Write the path's own columns as they were, and the prediction; cells of rows without one are empty.

    Args:
        path: as it was read from its file.
        prediction: of each of its rows.
        output: file to write, whole or not at all.
    """
    numbers = np.hstack([prediction.position_mm, 1e3 * prediction.error_mm, 1e3 * prediction.u_mm])
    rows = ([*row.cells.values(), *_cells(own)] for row, own in zip(path.rows, numbers, strict=True))
    write_atomically(output, csv_text([*path.rows[0].cells, *ADDED], rows))


def _cells(numbers: Floats) -> list[str]:
    # Adding 0.0 turns a rounded −0 into 0.
    return [
        f"{round(float(value), decimals) + 0.0:.{decimals}f}" if np.isfinite(value) else ""
        for value, decimals in zip(numbers, _DECIMALS, strict=True)
    ]
