"""Writing tables as CSV: no text of a cell becomes a formula in a spreadsheet, and reading gives it back."""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

_MARK: Final = "'"
"""Spreadsheets take a cell behind it for text."""

# A spreadsheet may split a line at semicolons, as it does where decimals have a comma, or at tabs, and ignores quotes
# that begin within a cell. Some take the signs of full width for the plain ones.
_BEGINNING: Final = r"(?<![^;\t\r\n])"
_FORMULA: Final = r"(?=(?:[^\S\t\r\n]|[\"'])*[=+\-@\uff1d\uff0b\uff0d\uff20]|'*[\t\r\n])"
_UNMARKED: Final = re.compile(_BEGINNING + _FORMULA)
_MARKED: Final = re.compile(_BEGINNING + _MARK + _FORMULA)
_NUMBER: Final = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True)
class OwnWord:
    """A word that the program alone can have written, +X for example: it stands as it is."""

    text: str

    def __str__(self) -> str:
        return self.text


def csv_text(names: Sequence[str], rows: Iterable[Sequence[object]], comments: Iterable[str] = ()) -> str:
    """Return a table as CSV.

    Args:
        rows: values in the order of the columns; None is an empty cell, numbers keep their full precision.
        comments: stand above the header, a line each.
    """
    out = io.StringIO()
    out.write(comment_lines(comments))
    writer = csv.writer(out, lineterminator="\n")
    for row in (names, *rows):
        writer.writerow([_cell(value) if isinstance(value, str) else value for value in row])
    return out.getvalue()


def comment_lines(texts: Iterable[str]) -> str:
    """Return what stands above the header of a table, a line each."""
    return "".join(f"# {_comment(' '.join(text.splitlines()))}\n" for text in texts)


def _comment(text: str) -> str:
    # Nothing quotes it: a spreadsheet splits it at commas too, and takes what follows a lone quote for quoted.
    return ",".join(marked(part) for part in text.replace('"', "'").split(","))


def uncommented(comment: str) -> str:
    """Return the text of a comment that `comment_lines` wrote, if there was no apostrophe in it."""
    return ",".join(unmarked(part) for part in comment.split(",")).replace("'", '"')


def _cell(text: str) -> str:
    # csv quotes a text for its line feeds, not for a carriage return, which most readers take for the end of a row.
    return marked("\n".join(re.split(r"\r\n?", text)))


def marked(text: str) -> str:
    """Return a text as it stands in a cell: what a spreadsheet would take for a formula is marked as text.

    That is the text itself, or what follows a semicolon, a tab or the end of a line in it.
    """
    return text if _NUMBER.fullmatch(text) else _UNMARKED.sub(_MARK, text)


def unmarked(cell: str) -> str:
    """Return the text of a cell that `marked` made."""
    return _MARKED.sub("", cell)
