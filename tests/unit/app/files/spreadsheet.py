"""What a spreadsheet makes of a CSV file, however it is set to split it."""

import csv
import io
import re
from itertools import takewhile

SIGNS = "=+-@\uff1d\uff0b\uff0d\uff20"
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)
"""One number, or the first of a line of them that is not split."""


def formulas(text: str) -> list[str]:
    """Return the cells of a CSV that some spreadsheet would take for a formula.

    Lines are split at commas, which quotes protect except in comments, and at semicolons or tabs, with quotes and
    without.
    """
    talk = takewhile(lambda line: line.startswith("#"), text.split("\n"))
    found = [cell for line in talk for cell in line.split(",")]
    found += [cell for line in csv.reader(io.StringIO(text)) for cell in line]
    for sign in ";\t":
        found += [cell for line in csv.reader(io.StringIO(text), delimiter=sign) for cell in line]
        found += [cell for line in re.split(r"[\r\n]", text) for cell in line.split(sign)]
    return [cell for cell in found if is_formula(cell)]


def is_formula(cell: str) -> bool:
    """Return whether a cell begins like a formula, behind blanks and quotes that are trimmed."""
    bare = cell.lstrip(' \t\r\n"')
    return bare.startswith(tuple(SIGNS)) and not NUMBER.fullmatch(bare.split(",")[0])
