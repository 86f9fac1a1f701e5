"""Numbers from CSV files of other programs: any separator, decimal comma, lines above the first row."""

import warnings
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.column_rules import LARGEST_NUMBER
from catseye.app.files.csv_lines import chunks, is_comment, lines_of
from catseye.calibration.core.types import Floats, Ints
from catseye.drivers.roles.text_table import SIGNS, Decimal, Dialect, Encoding, Separator, codec_of

_CANDIDATES: Final[tuple[tuple[Separator, Decimal], ...]] = (
    ("tab", "."),
    ("tab", ","),
    (";", ","),
    (";", "."),
    (",", "."),
    ("blank", "."),
    ("blank", ","),
)
_SURE: Final = frozenset({"tab", ";"})
"""Separators that no number and hardly a name contains: a blank or comma beside them belongs to a cell."""

_PROBED: Final = 200
"""Lines that are looked at to find out how a file is written."""

_ROWS_IN_TURN: Final = 3
"""So many rows of as many numbers begin the table."""

_FEWEST_NUMBERS: Final = 2
"""Of a row that holds names, too."""


def first_lines(path: Path, codec: str, count: int) -> list[str]:
    """Return the first lines of a file.

    Args:
        codec: of its text, as Python calls it.

    Raises:
        UsageError: the file cannot be read as such text.
    """
    return list(islice((line for _, text, _ in chunks(path, codec) for line in lines_of(text)), count))


def found_dialect(path: Path, *, named: bool = False) -> Dialect:
    """Return how a file is written, as its first lines show.

    Args:
        named: rows hold names and other texts, too, beside two numbers or more.

    Raises:
        UsageError: no table of numbers begins there.
    """
    encoding = _found_encoding(path)
    lines = first_lines(path, codec_of(encoding), _PROBED)
    found: list[tuple[bool, int, int, Dialect]] = []
    for separator, decimal in _CANDIDATES:
        dialect = Dialect(separator, decimal, 0, encoding)
        rows = [_numbers_in(dialect, line, named=named) for line in lines]
        start = _start_of_table(rows)
        if start is not None:
            dialect = Dialect(separator, decimal, start, encoding)
            # A table of one column contains no separator at all.
            sure = separator in _SURE and len(rows[start]) > 1
            found.append((not sure, -sum(rows[start]), start, dialect))
    if not found:
        raise UsageError(
            f"{path}: no table of numbers begins in its first {_PROBED} lines: export the samples as text, a row each"
        )
    return min(found, key=lambda one: one[:3])[3]


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
    for first, text, _ in chunks(path, dialect.codec):
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
                lines, comments=None, delimiter=SIGNS[dialect.separator], usecols=columns, ndmin=2
            )
    except (ValueError, IndexError, Warning):
        return None
    return (
        values if values.shape[0] == len(lines) and bool((np.abs(values) <= LARGEST_NUMBER).all()) else None
    )


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
        if not abs(value) <= LARGEST_NUMBER:
            raise UsageError(
                f"{path}:{number}: column {place + 1} holds {cells[place]!r}, no number with a decimal "
                f"{'comma' if dialect.decimal == ',' else 'point'}: correct the mapping, or cut the file before it"
            )
        values.append(value)
    return values


def _numbers_in(dialect: Dialect, line: str, *, named: bool) -> tuple[bool, ...]:
    """Return which cells of a line are numbers; empty where it is no row."""
    if not named:
        return (True,) * len(dialect.numbers(line) or ())
    try:
        cells = dialect.cells(line)
    except ValueError:
        return ()
    found = tuple(is_number(dialect, cell) for cell in cells)
    return found if sum(found) >= _FEWEST_NUMBERS else ()


def is_number(dialect: Dialect, cell: str) -> bool:
    """Return whether a cell is a number, as the file writes them."""
    try:
        dialect.number(cell)
    except ValueError:
        return False
    return True


def _start_of_table(rows: list[tuple[bool, ...]]) -> int | None:
    for start in range(len(rows) - _ROWS_IN_TURN + 1):
        if rows[start] and len(set(rows[start : start + _ROWS_IN_TURN])) == 1:
            return start
    return None


def _found_encoding(path: Path) -> Encoding:
    try:
        first_lines(path, codec_of("utf-8"), _PROBED)
    except UsageError:
        first_lines(path, codec_of("cp1252"), _PROBED)
        return "cp1252"
    return "utf-8"
