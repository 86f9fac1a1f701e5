"""Points files: one distance a row, in measuring order (version 1)."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from catseye.app.files.attached import document_comments
from catseye.app.files.columns import read_table
from catseye.app.files.csv_text import csv_text
from catseye.calibration.scara.points import Commands, Points
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule
from catseye.procedures.scara.path.tables import DIRECTIONS, JOINTS

_REQUIRED = (
    ColumnRule("reflector", "name", known_to="the cell file"),
    ColumnRule("segment", "integer"),
    *JOINTS,
    *DIRECTIONS,
    ColumnRule("displacement_mm", unit="mm"),
)

POINTS = TableRule(
    "points",
    "one distance",
    (
        (
            *_REQUIRED,
            # A distance with a larger uncertainty would say nothing about an error map.
            ColumnRule(
                "sigma_mm",
                unit="mm",
                optional=True,
                positive=True,
                largest=1.0,
                hint="it seems to be in µm; convert it to mm",
            ),
            ColumnRule("mount_deg", unit="°", optional=True),
            ColumnRule("returned", "integer", optional=True, largest=1, hint="it is 1 for a return, else 0"),
        ),
    ),
)

COLUMNS = tuple(column.name for column in _REQUIRED)

_WHERE_NOT_ZERO = ("mount_deg", "returned")
"""Columns that a table without them has with zeros."""


def read_points(path: Path, reflectors: Iterable[str]) -> Columns:
    """Read a points file.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
    """
    return read_table(path, POINTS, tuple(reflectors))


def point_columns(rows: Sequence[Mapping[str, object]]) -> Columns:
    """Return distances, one a mapping by the names of the columns, as a points file holds them."""
    names = tuple(dict.fromkeys(str(row["reflector"]) for row in rows))
    values = {name: np.array([float(str(row[name])) for row in rows]) for name in COLUMNS[1:]}
    reflector = np.array([float(names.index(str(row["reflector"]))) for row in rows])
    given = {name: np.array([float(str(row.get(name) or 0.0)) for row in rows]) for name in _WHERE_NOT_ZERO}
    further = {name: column for name, column in given.items() if column.any()}
    return Columns({"reflector": reflector, **values, **further}, np.arange(1, len(rows) + 1), names)


def with_sigma(points: Columns, sigma_mm: float) -> Columns:
    """Return distances that state one standard uncertainty, mm."""
    return replace(points, values={**points.values, "sigma_mm": np.full(len(points), sigma_mm)})


def points_csv(points: Columns, documents: Mapping[str, object] | None = None) -> str:
    """Return the text of a points file; numbers keep their full precision.

    Args:
        documents: that the table carries along, by kind.
    """
    (form,) = POINTS.forms
    columns = [column for column in form if column.name in points]
    cells = (_cells(column, points) for column in columns)
    comments = document_comments(documents or {})
    return csv_text([column.name for column in columns], zip(*cells, strict=True), comments)


def _cells(column: ColumnRule, points: Columns) -> list[object]:
    values = points[column.name]
    match column.kind:
        case "name":
            return [points.names[place] for place in values.astype(np.int64)]
        case "integer" | "direction":
            return list(values.astype(np.int64).tolist())
        case "number":
            return list(values.tolist())


def to_points(table: Columns, reflectors: Iterable[str]) -> Points:
    """Return distances for a solver; reflectors in the order of the cell file, those without a distance left out."""
    found, segment = table["reflector"].astype(np.int64), table["segment"].astype(np.int64)
    present = {table.names[place] for place in set(found.tolist())}
    names = tuple(name for name in reflectors if name in present)
    keys = list(zip(found.tolist(), segment.tolist(), strict=True))
    number = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    place = {table.names.index(name): i for i, name in enumerate(names)}
    return Points(
        commands=commands_of(table),
        reflector=np.array([place[key[0]] for key in keys], dtype=np.int64),
        dead_path=np.array([number[key] for key in keys], dtype=np.int64),
        displacement_mm=table["displacement_mm"],
        sigma_mm=table.get("sigma_mm"),
        reflector_names=names,
        dead_paths=tuple((table.names[key[0]], key[1]) for key in number),
        mount_rad=None if (mount := table.get("mount_deg")) is None else np.deg2rad(mount),
        returned=None if (returned := table.get("returned")) is None else returned != 0.0,
    )


def commands_of(table: Columns) -> Commands:
    """Return the joint commands of a table that has their columns."""
    return Commands(
        np.deg2rad(table["theta1_deg"]),
        np.deg2rad(table["theta2_deg"]),
        table["direction1"].astype(np.int64),
        table["direction2"].astype(np.int64),
    )
