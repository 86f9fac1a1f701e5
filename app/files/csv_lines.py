"""Lines of CSV tables: UTF-8, commas, a header line, comment lines; every complaint names file and line."""

import csv
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final

from catseye.app.errors import UsageError
from catseye.app.files.csv_text import unmarked
from catseye.drivers.roles.text_table import plain_digits
from catseye.drivers.roles.user_file import require_regular

LONGEST_LINE: Final = 64 * 1024
"""Characters; a table of instruments has lines of a few hundred."""

_CHUNK_BYTES = 4_000_000
"""Some 50 000 lines of points."""

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

    def fault(self, text: str) -> UsageError:
        """Return a complaint that names file and line."""
        return UsageError(f"{self.path}:{self.line}: {text}")


def chunks(path: Path, encoding: str = "utf-8-sig") -> Iterator[tuple[int, str, float]]:
    """Read a file, which may be a pipe, some megabytes at a time.

    Args:
        path: the file.
        encoding: one in which a line feed is one byte of its own.

    Yields:
        The number of the first line, whole lines that end with line feeds, and the share of the file that is read.

    Raises:
        UsageError: the file is missing, cannot be read, or holds what no table does; names file and line.
    """
    with named_faults(path):
        stream = path.open("rb")
    with stream:
        yield from _whole_lines(path, stream, max(path.stat().st_size, 1), encoding)


def _whole_lines(path: Path, stream: BinaryIO, size: int, encoding: str) -> Iterator[tuple[int, str, float]]:
    line, rest, read = 1, b"", 0
    while chunk := _read(path, stream):
        read += len(chunk)
        rest += chunk
        # A carriage return at the very end may be the first half of what ends a line.
        whole = max(rest.rfind(b"\n"), rest.rfind(b"\r", 0, -1)) + 1
        if whole:
            text = _table_text(path, line, rest[:whole], encoding)
            # A pipe has no size.
            yield line, text, min(read / size, 1.0)
            line, rest, encoding = line + text.count("\n"), rest[whole:], encoding.removesuffix("-sig")
        if len(rest) > 4 * LONGEST_LINE:
            require_line(path, line, rest.decode(encoding, "surrogateescape"))
    if rest:
        yield line, _table_text(path, line, rest, encoding), 1.0


def _read(path: Path, stream: BinaryIO) -> bytes:
    with named_faults(path):
        return stream.read(_CHUNK_BYTES)


def _table_text(path: Path, first_line: int, raw: bytes, encoding: str) -> str:
    text = raw.decode(encoding, "surrogateescape")
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if not text.isascii() or "\0" in text:
        for number, line in enumerate(lines_of(text), first_line):
            require_line(path, number, line)
    return text


def lines_of(text: str) -> list[str]:
    """Return the lines of a chunk; other signs than line feeds end none."""
    lines = text.split("\n")
    return lines if lines[-1] else lines[:-1]


def csv_row(path: Path, number: int, line: str, header: list[str]) -> CsvRow:
    """Return one line below the header.

    Raises:
        UsageError: it has another number of values than the header has columns.
    """
    cells = cells_of(path, number, line)
    if len(cells) != len(header):
        likely = (
            "a decimal comma makes two values of one: write points in the decimals"
            if len(cells) > len(header)
            else "the line is cut, or a value is missing"
        )
        raise UsageError(
            f"{path}:{number}: {len(cells)} values, but the header has {len(header)} columns; {likely}"
        )
    return CsvRow(path, number, dict(zip(header, cells, strict=True)))


def finite(text: str) -> float:
    """Return the number of a cell.

    Raises:
        ValueError: it is none, or none that is finite.
    """
    value = float(plain_digits(text))
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def is_comment(line: str) -> bool:
    """Return whether a line is a comment or blank."""
    return not line.strip() or line.lstrip().startswith("#")


def cells_of(path: Path, number: int, line: str) -> list[str]:
    """Return the cells of a line, without blanks around them.

    Raises:
        UsageError: it is no line that a table may have.
    """
    cells = next(csv.reader([require_line(path, number, line)]))
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
        number: where it stands, from 1.
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
        raise UsageError(
            f"{path}:{number}: the line holds NUL bytes: this is not CSV; export it as UTF-8 CSV"
        )
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
        raise UsageError(f"{str(path)!r}: is not a file name: {error}") from error


def require_file(path: Path) -> None:
    """Refuse a table that is no regular file: waiting for a pipe here could not be interrupted.

    Raises:
        UsageError: the file is missing or something else.
    """
    with named_faults(path):
        require_regular(path)
