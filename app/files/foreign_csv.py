"""Numbers from CSV files of other programs: any separator, decimal comma, lines above the first row."""

import csv
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.csv_lines import chunks, is_comment, lines_of
from catseye.calibration.core.types import Floats, Ints

Separator: TypeAlias = Literal[",", ";", "tab", "blank"]
Decimal: TypeAlias = Literal[".", ","]
Encoding: TypeAlias = Literal["utf-8", "cp1252"]

_SIGNS: Final[dict[Separator, str | None]] = {",": ",", ";": ";", "tab": "\t", "blank": None}
_CANDIDATES: Final[tuple[tuple[Separator, Decimal], ...]] = (
    ("tab", "."),
    ("tab", ","),
    (";", ","),
    (";", "."),
    (",", "."),
    ("blank", "."),
    ("blank", ","),
)
_PROBED: Final = 200
"""Lines that are looked at to find out how a file is written."""

_ROWS_IN_TURN: Final = 3
"""So many rows of as many numbers begin the table."""


@dataclass(frozen=True)
class Dialect:
    """How a file is written.

    Attributes:
        separator: between the columns; "blank" stands for any number of blanks and tabs.
        decimal: sign before the decimals.
        header_lines: lines above the first row.
        encoding: of its text.
    """

    separator: Separator
    decimal: Decimal
    header_lines: int
    encoding: Encoding

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line, without blanks and quotes around them."""
        sign = _SIGNS[self.separator]
        cells = line.split() if sign is None else next(csv.reader([line], delimiter=sign), [])
        return [cell.strip().strip('"') for cell in cells]

    def numbers(self, line: str) -> list[float] | None:
        """Return the numbers of a line; None when one of its cells is none."""
        cells = self.cells(line)
        while cells and not cells[-1]:
            cells.pop()
        try:
            return [self.number(cell) for cell in cells] or None
        except ValueError:
            return None

    def number(self, cell: str) -> float:
        """Return the number of a cell.

        Raises:
            ValueError: it is none.
        """
        if self.decimal == ",":
            if "." in cell:
                raise ValueError(cell)
            cell = cell.replace(",", ".")
        return float(cell)


def first_lines(path: Path, encoding: Encoding, count: int) -> list[str]:
    """Return the first lines of a file.

    Raises:
        UsageError: the file cannot be read as such text.
    """
    return list(
        islice((line for _, text, _ in chunks(path, _codec(encoding)) for line in lines_of(text)), count)
    )


def found_dialect(path: Path) -> Dialect:
    """Return how a file is written, as its first lines show.

    Raises:
        UsageError: no table of numbers begins there.
    """
    encoding = _found_encoding(path)
    lines = first_lines(path, encoding, _PROBED)
    found: list[tuple[int, int, Dialect]] = []
    for separator, decimal in _CANDIDATES:
        dialect = Dialect(separator, decimal, 0, encoding)
        counts = [len(dialect.numbers(line) or ()) for line in lines]
        start = _start_of_table(counts)
        if start is not None:
            found.append((-counts[start], start, Dialect(separator, decimal, start, encoding)))
    if not found:
        raise UsageError(
            f"{path}: no table of numbers begins in its first {_PROBED} lines: export the samples as text, a row each"
        )
    return min(found, key=lambda one: one[:2])[2]


def read_numbers(path: Path, dialect: Dialect, columns: Sequence[int]) -> tuple[list[Floats], Ints]:
    """Read columns of a file.

    Args:
        columns: their places, from 0.

    Returns:
        The columns, shape (n,) each, and the number of each row's line, from 1, shape (n,).

    Raises:
        UsageError: the file is missing, cannot be read, has no rows, or a cell is no number; names file and line.
    """
    blocks: list[tuple[Floats, Ints]] = []
    for first, text, _ in chunks(path, _codec(dialect.encoding)):
        lines = lines_of(text)
        above = max(0, dialect.header_lines + 1 - first)
        if lines[above:]:
            blocks.append(_rows(path, dialect, columns, first + above, lines[above:]))
    rows = np.concatenate([values for values, _ in blocks]) if blocks else np.empty((0, len(columns)))
    if not rows.size:
        raise UsageError(f"{path}: no row stands below its {dialect.header_lines} header lines")
    return list(rows.T), np.concatenate([numbers for _, numbers in blocks])


def _rows(
    path: Path, dialect: Dialect, columns: Sequence[int], first: int, lines: list[str]
) -> tuple[Floats, Ints]:
    values = _at_once(dialect, columns, lines)
    if values is not None:
        return values, np.arange(first, first + len(lines))
    kept = [(number, line) for number, line in enumerate(lines, first) if not is_comment(line)]
    found = [_row(path, dialect, columns, number, line) for number, line in kept]
    return np.reshape(found, (-1, len(columns))), np.array([number for number, _ in kept], dtype=np.int64)


def _at_once(dialect: Dialect, columns: Sequence[int], lines: list[str]) -> Floats | None:
    """Return rows of plain numbers; None when a line holds anything else."""
    if dialect.decimal == ",":
        whole = "\n".join(lines)
        if "." in whole:
            return None
        lines = whole.replace(",", ".").split("\n")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            values = np.loadtxt(
                lines, comments=None, delimiter=_SIGNS[dialect.separator], usecols=columns, ndmin=2
            )
    except (ValueError, IndexError, Warning):
        return None
    return values if values.shape[0] == len(lines) and bool(np.isfinite(values).all()) else None


def _row(path: Path, dialect: Dialect, columns: Sequence[int], number: int, line: str) -> list[float]:
    cells = dialect.cells(line)
    values = []
    for place in columns:
        if place >= len(cells):
            raise UsageError(
                f"{path}:{number}: {len(cells)} columns, but column {place + 1} is wanted: the file is cut off "
                "there, or the mapping names another separator"
            )
        try:
            value = dialect.number(cells[place])
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise UsageError(
                f"{path}:{number}: column {place + 1} holds {cells[place]!r}, no number with a decimal "
                f"{'comma' if dialect.decimal == ',' else 'point'}: correct the mapping, or cut the file before it"
            )
        values.append(value)
    return values


def _start_of_table(counts: list[int]) -> int | None:
    for start in range(len(counts) - _ROWS_IN_TURN + 1):
        if counts[start] and len(set(counts[start : start + _ROWS_IN_TURN])) == 1:
            return start
    return None


def _found_encoding(path: Path) -> Encoding:
    try:
        first_lines(path, "utf-8", _PROBED)
    except UsageError:
        first_lines(path, "cp1252", _PROBED)
        return "cp1252"
    return "utf-8"


def _codec(encoding: Encoding) -> str:
    return "utf-8-sig" if encoding == "utf-8" else encoding
