"""Writing tables as CSV: no text of a cell becomes a formula in a spreadsheet, and reading gives it back."""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from typing import Final

_MARK: Final = "'"
"""Spreadsheets take a cell behind it for text."""

# Some spreadsheets take the signs of full width for the plain ones.
_FORMULA: Final = re.compile(r"'*(\s*[=+\-@\uff1d\uff0b\uff0d\uff20]|[\t\r\n])")
_MARKED: Final = re.compile(_MARK + _FORMULA.pattern)
_NUMBER: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def csv_text(names: Sequence[str], rows: Iterable[Sequence[object]], comments: Iterable[str] = ()) -> str:
    """Return a table as CSV.

    Args:
        names: of the columns.
        rows: values in the order of the columns; None is an empty cell, numbers keep their full precision.
        comments: stand above the header, a line each.
    """
    out = io.StringIO()
    out.writelines(f"# {' '.join(text.splitlines())}\n" for text in comments)
    writer = csv.writer(out, lineterminator="\n")
    for row in (names, *rows):
        writer.writerow([_cell(value) if isinstance(value, str) else value for value in row])
    return out.getvalue()


def _cell(text: str) -> str:
    # csv quotes a text for its line feeds, not for a carriage return, which most readers take for the end of a row.
    return marked("\n".join(re.split(r"\r\n?", text)))


def marked(text: str) -> str:
    """Return a text as it stands in a cell: what a spreadsheet would take for a formula is marked as text."""
    return _MARK + text if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def unmarked(cell: str) -> str:
    """Return the text of a cell that `marked` made."""
    return cell.removeprefix(_MARK) if _MARKED.match(cell) else cell
