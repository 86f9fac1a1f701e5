"""Positions that a tracker's own program has written: suggested mapping, preview, and how they belong to a path."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.foreign_csv import is_number
from catseye.app.files.mapped_table import read_mapped
from catseye.app.results.mapping import ForeignTable, doubted_units, foreign_table, read_mapping, unit_of
from catseye.app.results.model import Report, Statement
from catseye.app.results.numbers import fixed, number
from catseye.app.results.preview import range_text, rows_report
from catseye.app.results.scara.path_csv import CommandPath
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.mapping import LENGTHS, MappedColumn
from catseye.procedures.scara.path.instrument_file import (
    PositionColumns,
    PositionsMapping,
    plane_normal,
    positions_in_plane,
    tilt_deg,
)
from catseye.procedures.scara.path.measured_path import by_mapping, require_places

_AXIS: Final = re.compile(r"(?:^|[^a-z])([xyz])(?:[^a-z]|$)", re.IGNORECASE)
_MEASURED: Final = re.compile(r"(?<![a-z])(?:act|meas|ist|gem)", re.IGNORECASE)
_DEG = fixed(3)


@dataclass(frozen=True)
class ForeignPositions:
    """A file of positions, and what was driven meanwhile.

    Attributes:
        mapping: how it is read.
        path: file with what was driven: its rows in order, once or in several passes.
    """

    mapping: PositionsMapping
    path: Path


def matched_places(file: Path, mapping: PositionsMapping, driven: CommandPath) -> tuple[Columns, int]:
    """Return where an instrument saw the commands of a path, the mean of all passes, and how many these are.

    Returns:
        Columns x_meas_mm, y_meas_mm and perhaps u_mm, with the lines of the first pass; and the passes.

    Raises:
        UsageError: the file cannot be read so, has another number of rows, or belongs to another path.
    """
    rows, commands = read_mapped(file, mapping), len(driven.commands)
    passes, left = divmod(len(rows), commands)
    if left or not passes:
        raise UsageError(
            f"{file}: holds {len(rows)} positions and the path has {commands} commands: each command that was driven "
            "needs a row, in the order of driving, once or as often as the path was driven"
        )
    try:
        places = positions_in_plane(str(file), rows, mapping)
        require_places(str(file), np.tile(driven.command_mm, (passes, 1)), places, by_mapping(mapping))
    except TableFileError as error:
        raise UsageError(str(error)) from error
    values = {name: column.reshape(passes, commands).mean(axis=0) for name, column in places.values.items()}
    return Columns(values, places.lines[:commands]), passes


@dataclass(frozen=True)
class PositionsPreview:
    """How a file of positions is read.

    Attributes:
        mapping: given, or found in the file.
        columns: as they are mapped.
        headings: above the mapped columns, by their names; empty where there are none.
        doubt: about their units; None where the headings state them.
    """

    mapping: PositionsMapping
    columns: Columns
    headings: dict[str, str]
    doubt: Statement | None


def preview_positions(path: Path, mapping: Path | None) -> PositionsPreview:
    """Read positions by a mapping, or by the one that their headings suggest.

    Raises:
        UsageError: the file cannot be read so; names line and remedy.
        ConfigError: the mapping is none of positions.
    """
    table = foreign_table(path, named=True)
    found = _found(table, path) if mapping is None else read_mapping(PositionsMapping, mapping)
    given = found.columns.given()
    headings = {
        name: table.headings[one.column - 1] if one.column <= len(table.headings) else ""
        for name, one in given.items()
    }
    return PositionsPreview(found, read_mapped(path, found), headings, doubted_units(path, found))


def positions_report(path: Path, shown: PositionsPreview) -> Report:
    """Return the first and the last rows as they are read, with the ranges of the coordinates."""
    columns = shown.columns
    entries = [("positions", str(len(columns)))]
    for name, values in columns.values.items():
        heading = f', under "{shown.headings[name]}"' if shown.headings[name] else ""
        entries.append((name, f"{range_text(values)}{heading}"))
    if "z_meas_mm" in columns:
        normal = plane_normal(columns.stacked(("x_meas_mm", "y_meas_mm", "z_meas_mm")))
        entries.append(
            ("tilt of their plane", f"{number(tilt_deg(normal), _DEG)}° against x and y, which is taken out")
        )
    return rows_report(path, entries, shown.doubt, columns)


def _found(table: ForeignTable, path: Path) -> PositionsMapping:
    """Return a mapping as headings and first row suggest; a person has to look at it."""
    places = _axes_by_headings(table.headings) or _axes_by_place(table)
    if len(places) < 2:
        raise UsageError(f"{path}: its rows have no two coordinates: export x, y and z of each point")
    dialect = table.dialect
    mapped = {
        f"{axis}_meas_mm": MappedColumn(column=place + 1, unit=_length_unit(table.headings[place]))
        for axis, place in places.items()
    }
    return PositionsMapping(
        separator=dialect.separator,
        decimal=dialect.decimal,
        header_lines=dialect.header_lines,
        encoding=dialect.encoding,
        columns=PositionColumns(**mapped),
    )


def _axes_by_headings(headings: list[str]) -> dict[str, int]:
    """Return the places of x, y and perhaps z as headings name them; measured ones before nominal ones."""
    named = [
        (place, found[1].lower()) for place, text in enumerate(headings) if (found := _AXIS.search(text))
    ]
    measured = [(place, axis) for place, axis in named if _MEASURED.search(headings[place])]
    places: dict[str, int] = {}
    for place, axis in measured or named:
        places.setdefault(axis, place)
    return dict(sorted(places.items(), key=lambda one: one[0])) if {"x", "y"} <= places.keys() else {}


def _axes_by_place(table: ForeignTable) -> dict[str, int]:
    """Return the first three columns of numbers, after one that counts the rows."""
    numbers = [place for place, cell in enumerate(table.row) if is_number(table.dialect, cell)]
    if len(numbers) > len("xyz") and table.row[numbers[0]] in ("0", "1"):
        numbers = numbers[1:]
    return dict(zip("xyz", numbers, strict=False))


def _length_unit(heading: str) -> str:
    unit = unit_of(heading)
    return unit if unit in LENGTHS else "mm"
