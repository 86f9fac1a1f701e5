"""Rows to be driven as they stand: the CSV of `catseye compensate`, or any with its first six columns."""

from functools import partial
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.files.csv_table import csv_rows

JOINT_ROWS = ("x_mm", "y_mm", "theta1_deg", "theta2_deg", "direction1", "direction2")
"""Columns that tell how to drive a row; take-ups follow from them."""


def read_joint_rows(path: Path) -> list[list[float]]:
    """Read x, y (mm), J1, J2 (deg) and the states of approach (1 or -1) of each row; further columns are passed over.

    Raises:
        UsageError: the file is missing or empty, a column is missing, a value is none; names file and line.
    """
    found = []
    for row in csv_rows(path, ",".join(JOINT_ROWS), partial(_check, path)):
        if not row.cells["theta1_deg"]:
            raise row.fault("has no corrected command: take the row out of the path, and compensate it again")
        numbers = [row.finite(name) for name in JOINT_ROWS[:4]]
        found.append([*numbers, *(float(row.direction(name)) for name in JOINT_ROWS[4:])])
    if not found:
        raise UsageError(f"{path}: holds no rows; each row below the header line is one")
    return found


def _check(path: Path, line: int, header: list[str]) -> None:
    missing = [name for name in JOINT_ROWS if name not in header]
    if missing:
        raise UsageError(
            f"{path}:{line}: column {', '.join(missing)} is missing: it takes the CSV that catseye compensate writes"
        )
