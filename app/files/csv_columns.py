"""CSV tables as columns: whole blocks at once, line by line only to name what is wrong in one."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.attached import attached_documents
from catseye.app.files.column_rules import (
    LARGEST_INTEGER,
    LARGEST_NUMBER,
    Form,
    first_fault,
    form_of,
    forms_text,
    header_fault,
    places_among,
)
from catseye.app.files.csv_lines import LONGEST_LINE, CsvRow, chunks, csv_row, header_of, is_comment, lines_of
from catseye.calibration.core.types import Floats
from catseye.drivers.roles.text_table import plain_digits
from catseye.procedures.kit.columns import ColumnRule, Columns, Kind, TableRule


def csv_blocks(path: Path, table: TableRule, names: tuple[str, ...]) -> Iterator[tuple[float, Columns]]:
    """Read a CSV table block by block; see `columns.table_blocks`."""
    for top, line, text, share in _below_header(path, table):
        form = form_of(table, top.header)
        block = _clean_columns(text, line, top.header, form, names)
        if block is None:
            _, block = _row_by_row(path, top.header, form, line, text, names)
        yield share, replace(block, attached=top.attached)


def csv_blocks_of_text(
    path: Path, table: TableRule, names: tuple[str, ...]
) -> Iterator[tuple[list[CsvRow], Columns]]:
    """Read the same with the text of the cells."""
    for top, line, text, _ in _below_header(path, table):
        yield _row_by_row(path, top.header, form_of(table, top.header), line, text, names)


@dataclass(frozen=True)
class _Top:
    """What stands above the rows.

    Attributes:
        header: names of the columns.
        attached: documents in the comments above it, JSON by their kind.
    """

    header: list[str]
    attached: Mapping[str, str]


def _below_header(path: Path, table: TableRule) -> Iterator[tuple[_Top, int, str, float]]:
    """Return the top, number of the first line, lines below the header, and the share of the file that is read."""
    top: _Top | None = None
    above: list[str] = []
    for first, text, share in chunks(path):
        line, below = first, text
        while top is None and below:
            one, _, below = below.partition("\n")
            if is_comment(one):
                above.append(one)
            else:
                top = _Top(_header(path, line, one, table), attached_documents(above))
            line += 1
        if top is not None and below:
            yield top, line, below, share
    if top is None:
        raise UsageError(f"{path}: is empty; the first line has to be the header {forms_text(table)}")


def _header(path: Path, number: int, line: str, table: TableRule) -> list[str]:
    header = header_of(path, number, line)
    if fault := header_fault(table, header):
        raise UsageError(f"{path}:{number}: {fault}")
    return header


def _clean_columns(
    text: str, first_line: int, header: list[str], form: Form, names: tuple[str, ...]
) -> Columns | None:
    """Return lines as columns at once; None when a line is not of plain numbers and known names."""
    kinds = {column.name: column.kind for column in form}
    if "#" in text or '"' in text or not set(header) <= set(kinds):
        return None
    types = {"name": f"U{1 + max(map(len, names), default=0)}", "integer": "i8"}
    record = np.dtype([(name, types.get(kinds[name], "f8")) for name in header])
    lines = lines_of(text)
    if max(map(len, lines)) > LONGEST_LINE:
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            rows = np.loadtxt(lines, record, comments=None, delimiter=",", ndmin=1)
    except (ValueError, Warning):
        return None
    if rows.size != len(lines):
        return None
    values = {name: _numbers(rows[name], kinds[name], names) for name in header}
    block = Columns(values, np.arange(first_line, first_line + rows.size), names)
    return None if first_fault(form, block) else block


def _numbers(values: Any, kind: Kind, names: tuple[str, ...]) -> Floats:
    if kind == "name":
        return places_among(values, names)
    if kind == "integer":
        return np.where((values < -LARGEST_INTEGER) | (values > LARGEST_INTEGER), np.inf, values)
    return np.asarray(values, dtype=np.float64)


def _row_by_row(
    path: Path, header: list[str], form: Form, first_line: int, text: str, names: tuple[str, ...]
) -> tuple[list[CsvRow], Columns]:
    """Return lines with the text of their cells.

    Raises:
        UsageError: a line or a value is wrong; names the first one.
    """
    rows: list[CsvRow] = []
    try:
        for number, line in enumerate(lines_of(text), first_line):
            if not is_comment(line):
                rows.append(csv_row(path, number, line, header))
    except UsageError:
        _columns(rows, form, names)  # a wrong value above this line is named first
        raise
    return rows, _columns(rows, form, names)


def _columns(rows: Sequence[CsvRow], form: Form, names: tuple[str, ...]) -> Columns:
    present = [column for column in form if rows and column.name in rows[0].cells]
    values = {
        column.name: np.array([_number(row.cells[column.name], column, names) for row in rows])
        for column in present
    }
    block = Columns(values, np.array([row.line for row in rows], dtype=np.int64), names)
    if fault := first_fault(form, block):
        place, column = fault
        raise rows[place].fault(_complaint(column, rows[place].cells[column.name], names))
    return block


def _number(text: str, column: ColumnRule, names: tuple[str, ...]) -> float:
    """Return what a cell holds; NaN or infinity, which no rule lets pass, for what it cannot."""
    if column.kind == "name":
        return float(names.index(text)) if text in names else -1.0
    try:
        if column.kind == "integer":
            return float(number) if abs(number := int(plain_digits(text))) <= LARGEST_INTEGER else np.inf
        return float(plain_digits(text))
    except ValueError:
        return np.nan


def _complaint(column: ColumnRule, text: str, names: tuple[str, ...]) -> str:
    if column.empty and not text:
        return column.empty
    if column.kind == "name":
        return f"unknown {column.name} {text!r}; {column.known_to} knows {', '.join(names)}"
    value = _number(text, column, names)
    largest = LARGEST_NUMBER if column.largest is None else column.largest
    if column.kind == "number" and largest < abs(value) < np.inf:
        beyond = f"more than {largest:g}" if value > 0.0 else f"less than {-largest:g}"
        return f"{column.name} = {value:g} is {beyond} {column.unit}: {column.hint or 'correct it'}"
    return f"{column.name} = {text!r} is not {column.wanted}"
