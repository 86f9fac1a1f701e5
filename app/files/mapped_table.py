"""Columns of a table that another program wrote, read by a mapping."""

from pathlib import Path

from catseye.app.files.foreign_csv import read_numbers
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.mapping import TableMapping


def read_mapped(path: Path, mapping: TableMapping) -> Columns:
    """Read the columns that are mapped, in the units of this program.

    Raises:
        UsageError: a cell is no number, or a column is missing; names file and line.
    """
    columns, given = mapping.columns, mapping.columns.given()
    found, lines = read_numbers(path, mapping.dialect, [one.column - 1 for one in given.values()])
    values = {
        name: one.sign * columns.units[name][one.unit] * column
        for (name, one), column in zip(given.items(), found, strict=True)
    }
    return Columns(values, lines)
