"""How a table of another program is read: its first and last rows, shown to a person before they are used."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.results.model import Column, Entries, Report, Statement, Table, section
from catseye.app.results.numbers import COUNT, Format, number
from catseye.app.results.origin import origin_now
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.columns import Columns

DIGITS: Final = Format("significant", 6)

_SHOWN: Final = 5
"""Rows of the beginning, and as many of the end."""


def as_it_is_read(columns: Columns) -> Table:
    """Return the first and the last rows, with their lines."""
    count, names = len(columns), list(columns.values)
    rows = np.unique(np.r_[0 : min(_SHOWN, count), max(count - _SHOWN, 0) : count])
    values = columns.stacked(names)
    return Table(
        "rows",
        "As it is read",
        (Column("line", "line", format=COUNT), *(Column(name, name, format=DIGITS) for name in names)),
        tuple((int(columns.lines[row]), *values[row].tolist()) for row in rows.tolist()),
    )


def rows_report(
    path: Path, entries: Sequence[tuple[str, str]], doubt: Statement | None, columns: Columns
) -> Report:
    """Return what is to know of a table, and its first and last rows as they are read."""
    blocks = [Entries(tuple(entries)), doubt, as_it_is_read(columns)]
    return Report(
        f"Preview of {path.name}", origin_now(), (section("preview", path.name, blocks, brief=True),)
    )


def range_text(values: Floats) -> str:
    """Return the smallest and the largest value."""
    return f"{number(float(values.min()), DIGITS)} … {number(float(values.max()), DIGITS)}"
