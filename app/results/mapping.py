"""Mapping files: read, written, and suggested by what a file of another program shows."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

import tomlkit

from catseye.app.cell.described import read_described
from catseye.app.files.foreign_csv import first_lines, found_dialect
from catseye.app.results.model import Sign, Statement
from catseye.drivers.roles.text_table import Dialect
from catseye.procedures.kit.mapping import TableMapping

MappingT = TypeVar("MappingT", bound=TableMapping)

_NAMED: Final = {
    "µ": "u",
    "μ": "u",
    '"': "arcsec",
    "''": "arcsec",
    "°": "deg",
    "sec": "s",
    "seconds": "s",
    "degrees": "deg",
    "in": "inch",
    "inches": "inch",
}
_IN_BRACKETS: Final = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]")
_LAST_WORD: Final = re.compile(r"[/_]\s*([^\W_]+|\S)\s*$")


def read_mapping(kind: type[MappingT], path: Path) -> MappingT:
    """Read a mapping.

    Raises:
        ConfigError: the file is missing or no mapping of this kind; the fault is named with its key.
    """
    return read_described(kind, path)


def mapping_text(mapping: TableMapping) -> str:
    """Return a mapping as TOML."""
    document = mapping.model_dump(exclude_none=True)
    columns = tomlkit.table()
    for name, one in document.pop("columns").items():
        columns.append(name, tomlkit.inline_table() | one)
    return tomlkit.dumps(document | {"columns": columns})


@dataclass(frozen=True)
class ForeignTable:
    """What the beginning of a table shows.

    Attributes:
        dialect: how it is written.
        headings: of the columns, empty where there are none.
        row: cells of its first row.
    """

    dialect: Dialect
    headings: list[str]
    row: list[str]


def foreign_table(path: Path, *, named: bool = False) -> ForeignTable:
    """Look at the beginning of a table that another program wrote.

    Args:
        named: rows hold names and other texts, too, beside their numbers.

    Raises:
        UsageError: no table of numbers begins in the file.
    """
    dialect = found_dialect(path, named=named)
    *above, first = first_lines(path, dialect.codec, dialect.header_lines + 1)
    row = dialect.cells(first)
    while not row[-1]:
        row.pop()
    cells = _headings(above, dialect)
    return ForeignTable(dialect, cells if len(cells) == len(row) else [""] * len(row), row)


def _headings(above: list[str], dialect: Dialect) -> list[str]:
    return next((dialect.cells(line) for line in reversed(above) if line.strip()), [])


def unit_of(heading: str) -> str:
    """Return the unit in a heading by the name that mappings have for it; empty where there is none."""
    found = _IN_BRACKETS.search(heading) or _LAST_WORD.search(heading)
    if found is None:
        return ""
    unit = found[1].lower()
    for sign, name in _NAMED.items():
        unit = name if unit == sign else unit.replace(sign, name) if sign in "µμ" else unit
    return unit


def doubted_units(path: Path, mapping: TableMapping) -> Statement | None:
    """Return which units a mapping takes that headings do not state in their brackets; None where all agree."""
    dialect, given = mapping.dialect, mapping.columns.given()
    headings = _headings(first_lines(path, dialect.codec, dialect.header_lines), dialect)
    if len(headings) < max(one.column for one in given.values()):
        return None
    doubts = [
        f'{name} is taken in {one.unit}, and its heading is "{heading}"'
        for name, one in given.items()
        if _IN_BRACKETS.search(heading := headings[one.column - 1]) and unit_of(heading) != one.unit
    ]
    if not doubts:
        return None
    return Statement(
        Sign.ATTENTION, f"{'; '.join(doubts)}: correct the unit in the mapping if it is another one."
    )
