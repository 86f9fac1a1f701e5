"""Tables as CSV: UTF-8, comma, a header line, comment lines; every complaint names file and line."""

import csv
import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Final, TypeVar

from catseye.app.errors import UsageError
from catseye.app.files.csv_text import unmarked
from catseye.drivers.roles.user_file import require_regular

T = TypeVar("T")

LONGEST_LINE: Final = 64 * 1024
"""Characters; a table of instruments has lines of a few hundred."""

_SURROGATE: Final = re.compile("[\udc80-\udcff]")
"""In place of bytes that are no UTF-8."""


@dataclass(frozen=True)
class CsvRow:
    """One line below the header.

    Attributes:
        path: the file.
        line: its number, from 1.
        cells: text by column, without blanks around it.
    """

    path: Path
    line: int
    cells: Mapping[str, str]

    def value(self, name: str, convert: Callable[[str], T], wanted: str) -> T:
        """Return a converted cell.

        Args:
            name: of the column.
            convert: raises ValueError for a text that is none.
            wanted: what the text should be, in words.

        Raises:
            UsageError: the text cannot be converted.
        """
        try:
            return convert(self.cells[name])
        except ValueError:
            raise self.fault(f"{name} = {self.cells[name]!r} is not {wanted}") from None

    def finite(self, name: str) -> float:
        """Return a finite number."""
        return self.value(name, finite, "a finite number")

    def direction(self, name: str) -> int:
        """Return a state of approach."""
        return self.value(name, _direction, "1 or -1")

    def positive(self, name: str) -> float:
        """Return a finite number above 0."""
        return self.value(name, _positive, "a finite number above 0")

    def fault(self, text: str) -> UsageError:
        """Return a complaint that names file and line."""
        return UsageError(f"{self.path}:{self.line}: {text}")


def csv_rows(path: Path, example: str, check: Callable[[int, list[str]], None]) -> Iterator[CsvRow]:
    """Read a table line by line.

    Args:
        path: the file.
        example: header that the file could have, for the complaint about an empty file.
        check: is told line and names of the header; raises UsageError for a wrong one.

    Raises:
        UsageError: the file is missing, cannot be read, or is no such table.
    """
    header: list[str] | None = None
    for number, line in _lines(path):
        if header is None:
            header = header_of(path, number, line)
            check(number, header)
            continue
        yield csv_row(path, number, line, header)
    if header is None:
        raise UsageError(f"{path}: is empty; the first line has to be the header {example}")


def csv_row(path: Path, number: int, line: str, header: list[str]) -> CsvRow:
    """Return one line below the header.

    Raises:
        UsageError: it has another number of values than the header has columns.
    """
    cells = cells_of(path, number, line)
    if len(cells) != len(header):
        raise UsageError(f"{path}:{number}: {len(cells)} values, but the header has {len(header)} columns")
    return CsvRow(path, number, dict(zip(header, cells, strict=True)))


def is_talk(line: str) -> bool:
    """Tell whether a line is a comment or blank."""
    return not line.strip() or line.lstrip().startswith("#")


def misnamed(header: list[str], allowed: tuple[str, ...]) -> str:
    """Return what is wrong with the names of a header: doubled, or unknown; empty when nothing is."""
    doubled = sorted({name for name in header if header.count(name) > 1})
    if doubled:
        return f"column {', '.join(doubled)} stands twice"
    unknown = [name for name in header if name not in allowed]
    return f"unknown column {', '.join(unknown)}" if unknown else ""


def finite(text: str) -> float:
    """Return a finite number.

    Raises:
        ValueError: it is none.
    """
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


def _positive(text: str) -> float:
    number = finite(text)
    if number <= 0.0:
        raise ValueError(text)
    return number


def _direction(text: str) -> int:
    number = float(text)
    if number not in (1.0, -1.0):
        raise ValueError(text)
    return int(number)


def cells_of(path: Path, number: int, line: str) -> list[str]:
    """Return the cells of a line, without blanks around them.

    Raises:
        UsageError: it is no line that a table may have.
    """
    try:
        cells = next(csv.reader([require_line(path, number, line)]))
    except csv.Error as error:
        # Such as a carriage return alone within it, with which other systems ended lines.
        raise UsageError(
            f"{path}:{number}: is no line of a table ({error}); export it as CSV whose lines end with line feeds"
        ) from error
    return [unmarked(cell.strip()) for cell in cells]


def header_of(path: Path, number: int, line: str) -> list[str]:
    """Return the names of a header line.

    Raises:
        UsageError: they are separated by something else than commas.
    """
    for sign, name in ((";", "semicolons"), ("\t", "tabs")):
        if sign in line and "," not in line:
            raise UsageError(
                f"{path}:{number}: the columns are separated by {name}: export the file with commas between the "
                "columns and points in the decimals"
            )
    return cells_of(path, number, line)


def require_line(path: Path, number: int, line: str) -> str:
    """Return a line that a table may have.

    Args:
        path: the file.
        number: of the line.
        line: decoded with surrogates in place of what is no UTF-8.

    Raises:
        UsageError: it is too long, holds NUL bytes or is no UTF-8 text.
    """
    if len(line) > LONGEST_LINE:
        raise UsageError(
            f"{path}:{number}: the line is too long for a table: it has more than {LONGEST_LINE} characters"
        )
    if not line.isascii() and _SURROGATE.search(line):
        raise UsageError(f"{path}:{number}: is not UTF-8 text; export it as UTF-8 CSV")
    if "\0" in line:
        raise UsageError(f"{path}:{number}: the line holds NUL bytes: this is no CSV; export it as UTF-8 CSV")
    return line


@contextmanager
def named_faults(path: Path) -> Iterator[None]:
    """Turn what keeps a file from being opened or read into a complaint that names it.

    Raises:
        UsageError: the file is missing, cannot be read, or has no valid name.
    """
    try:
        yield
    except FileNotFoundError as error:
        raise UsageError(f"{path}: there is no such file") from error
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise UsageError(f"{str(path)!r}: is no name of a file: {error}") from error


def require_file(path: Path) -> None:
    """Refuse a table that is no regular file: waiting for a pipe here could not be interrupted.

    Raises:
        UsageError: the file is missing or something else.
    """
    with named_faults(path):
        require_regular(path)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Read line by line, so that a pipe serves as well as a file."""
    with named_faults(path):
        stream = path.open(encoding="utf-8-sig", errors="surrogateescape")
    with stream:
        for number in count(1):
            with named_faults(path):
                line = stream.readline(LONGEST_LINE + 1)
            if not line:
                return
            require_line(path, number, line)
            if not is_talk(line):
                yield number, line.rstrip("\n")
