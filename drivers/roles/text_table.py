"""How a table that another program wrote as text is written: separator, decimal sign, lines above its first row."""

import csv
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

Separator: TypeAlias = Literal[",", ";", "tab", "blank"]
Decimal: TypeAlias = Literal[".", ","]
Encoding: TypeAlias = Literal["utf-8", "cp1252"]

SIGNS: Final[dict[Separator, str | None]] = {",": ",", ";": ";", "tab": "\t", "blank": None}
"""What Python takes for a separator; None for any number of blanks and tabs."""


def codec_of(encoding: Encoding) -> str:
    """Return an encoding as Python calls it; a mark at the beginning of the file is passed over."""
    return "utf-8-sig" if encoding == "utf-8" else encoding


def plain_digits(text: str) -> str:
    """Return the text of a number for `float` and `int`, which take underscores between digits, as no file has them.

    Raises:
        ValueError: an underscore is in it.
    """
    if "_" in text:
        raise ValueError(text)
    return text


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

    @property
    def codec(self) -> str:
        """The encoding as Python calls it."""
        return codec_of(self.encoding)

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line, without blanks and quotes around them.

        Raises:
            ValueError: it is no line, or a cell is endless.
        """
        sign = SIGNS[self.separator]
        try:
            cells = line.split() if sign is None else next(csv.reader([line], delimiter=sign), [])
        except csv.Error as error:
            raise ValueError(str(error)) from None
        return [cell.strip().strip('"') for cell in cells]

    def numbers(self, line: str) -> list[float] | None:
        """Return the numbers of a line; None when one of its cells is none."""
        try:
            cells = self.cells(line)
            while cells and not cells[-1]:
                cells.pop()
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
        return float(plain_digits(cell))
