"""Points CSV: one distance a row, in measuring order (version 1)."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.csv_table import CsvRow, csv_rows, misnamed
from catseye.app.files.csv_text import csv_text
from catseye.calibration.scara.points import Commands, Points

COLUMNS = (
    "reflector",
    "segment",
    "theta1_deg",
    "theta2_deg",
    "direction1",
    "direction2",
    "displacement_mm",
)
OPTIONAL = ("sigma_mm",)

LARGEST_SEGMENT = 2**53
"""Every format keeps integers up to this one exactly."""

LARGEST_SIGMA_MM = 1.0
"""A distance with a larger uncertainty would tell nothing about an error map: such numbers are µm."""


@dataclass(frozen=True)
class PointRow:
    """One distance.

    Attributes:
        reflector: name.
        segment: number of the unbroken stretch; each has a dead path of its own.
        theta1_deg: J1 command.
        theta2_deg: J2 command.
        direction1: state of approach of J1, 1 or -1.
        direction2: state of approach of J2, 1 or -1.
        displacement_mm: relative to the segment's zero.
        sigma_mm: standard uncertainty; None when not stated.
    """

    reflector: str
    segment: int
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    displacement_mm: float
    sigma_mm: float | None


def points_csv(rows: Iterable[PointRow]) -> str:
    """Return the text of a points file; numbers keep their full precision."""
    table = list(rows)
    with_sigma = any(row.sigma_mm is not None for row in table)
    names = COLUMNS + (OPTIONAL if with_sigma else ())
    return csv_text(names, ([getattr(row, name) for name in names] for row in table))


def read_points_csv(path: Path, reflectors: Iterable[str]) -> list[PointRow]:
    """Read a points file.

    Args:
        path: the file.
        reflectors: names that the cell file knows.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
    """
    known = list(reflectors)
    found = csv_rows(path, ",".join(COLUMNS), partial(require_columns, path))
    rows = [point_row(row, known) for row in found]
    if not rows:
        raise UsageError(f"{path}: holds no points; each row below the header line is one distance")
    return rows


def to_points(rows: list[PointRow], reflectors: Iterable[str]) -> Points:
    """Return rows as columns; reflectors in the order of the cell file."""
    present = {row.reflector for row in rows}
    names = tuple(name for name in reflectors if name in present)
    paths = tuple(dict.fromkeys((row.reflector, row.segment) for row in rows))
    path_index = {key: i for i, key in enumerate(paths)}
    sigma = [row.sigma_mm for row in rows]
    commands = Commands(
        np.deg2rad([row.theta1_deg for row in rows]),
        np.deg2rad([row.theta2_deg for row in rows]),
        np.array([row.direction1 for row in rows], dtype=np.int64),
        np.array([row.direction2 for row in rows], dtype=np.int64),
    )
    return Points(
        commands=commands,
        reflector=np.array([names.index(row.reflector) for row in rows], dtype=np.int64),
        dead_path=np.array([path_index[row.reflector, row.segment] for row in rows], dtype=np.int64),
        displacement_mm=np.array([row.displacement_mm for row in rows]),
        sigma_mm=None if None in sigma else np.array(sigma, dtype=np.float64),
        reflector_names=names,
        dead_paths=paths,
    )


def require_columns(path: Path, line: int, header: list[str]) -> None:
    """Check the header of a points file.

    Raises:
        UsageError: a column is missing, unknown or stands twice.
    """
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise UsageError(
            f"{path}:{line}: column {', '.join(missing)} is missing; the header has to be "
            f"{','.join(COLUMNS)}[,sigma_mm], comma separated"
        )
    if fault := misnamed(header, COLUMNS + OPTIONAL):
        raise UsageError(f"{path}:{line}: {fault}; allowed are {','.join(COLUMNS)}[,sigma_mm]")


def point_row(row: CsvRow, known: list[str]) -> PointRow:
    """Return a line of a points file as a distance.

    Raises:
        UsageError: a value is wrong, or the reflector is none of the known ones.
    """
    reflector = row.cells["reflector"]
    if reflector not in known:
        raise row.fault(f"unknown reflector {reflector!r}; the cell file knows {', '.join(known)}")
    return PointRow(
        reflector=reflector,
        segment=row.value("segment", _segment, "an integer up to 2^53"),
        theta1_deg=row.finite("theta1_deg"),
        theta2_deg=row.finite("theta2_deg"),
        direction1=row.direction("direction1"),
        direction2=row.direction("direction2"),
        displacement_mm=row.finite("displacement_mm"),
        sigma_mm=_sigma_mm(row) if "sigma_mm" in row.cells else None,
    )


def _sigma_mm(row: CsvRow) -> float:
    sigma_mm = row.positive("sigma_mm")
    if sigma_mm > LARGEST_SIGMA_MM:
        raise row.fault(
            f"sigma_mm = {sigma_mm:g} is more than {LARGEST_SIGMA_MM:g} mm: it seems to be in µm; convert it to mm"
        )
    return sigma_mm


def _segment(text: str) -> int:
    number = int(text)
    if abs(number) > LARGEST_SEGMENT:
        raise ValueError(text)
    return number
