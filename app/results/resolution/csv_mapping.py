"""Mappings of CSV files that other programs wrote: which of their columns are what, kept as a small TOML file."""

import math
import re
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
import tomlkit
from pydantic import Field, model_validator

from catseye.app.cell.described import read_described
from catseye.app.cell.section import Positive, Section
from catseye.app.errors import ConfigError
from catseye.app.files.foreign_csv import first_lines, found_dialect, read_numbers
from catseye.drivers.roles.text_table import Decimal, Dialect, Encoding, Separator
from catseye.procedures.kit.columns import Columns

_DEG: Final = math.degrees(1.0)

_UNITS: Final = {
    "t_s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "displacement_mm": {"mm": 1.0, "um": 1e-3, "nm": 1e-6, "m": 1e3, "inch": 25.4},
    "angle_deg": {
        "deg": 1.0,
        "mdeg": 1e-3,
        "arcmin": 1.0 / 60.0,
        "arcsec": 1.0 / 3600.0,
        "rad": _DEG,
        "mrad": 1e-3 * _DEG,
        "urad": 1e-6 * _DEG,
    },
}
"""What a unit is worth, by the column that it is turned into."""

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
}
_UNIT_IN_HEADING: Final = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]|[/_]\s*(\w+|\S)\s*$")
_TIME_HEADING: Final = re.compile(r"\s*(t|time|zeit|temps|tempo)\b", re.IGNORECASE)


class MappedColumn(Section):
    """Where a column of the recording comes from: its place from 1, the unit there, 1 or −1 for its sign."""

    column: Annotated[int, Field(ge=1, le=1000)]
    unit: str
    sign: Literal[1, -1] = 1


class MappedColumns(Section):
    """Columns of the recording; displacements of the optics or angles."""

    t_s: MappedColumn | None = None
    displacement_mm: MappedColumn | None = None
    angle_deg: MappedColumn | None = None

    def given(self) -> dict[str, MappedColumn]:
        """Return those that are stated, by name."""
        return {name: one for name in _UNITS if (one := getattr(self, name)) is not None}

    @model_validator(mode="after")
    def _are_a_recording(self) -> Self:
        if (self.displacement_mm is None) == (self.angle_deg is None):
            raise ValueError("state either displacement_mm or angle_deg")
        for name, one in self.given().items():
            if one.unit not in _UNITS[name]:
                raise ValueError(f"{name}: unknown unit {one.unit!r}; there are {', '.join(_UNITS[name])}")
        return self


class CsvMapping(Section):
    """A whole mapping file."""

    format: Literal["catseye-mapping/1"] = "catseye-mapping/1"
    separator: Separator
    decimal: Decimal
    header_lines: Annotated[int, Field(ge=0, le=10_000)]
    encoding: Encoding = "utf-8"
    rate_hz: Positive | None = None
    columns: MappedColumns

    @model_validator(mode="after")
    def _has_times(self) -> Self:
        if self.columns.t_s is None and self.rate_hz is None:
            raise ValueError(
                "state the column t_s, or rate_hz for a file without times; with both, they must agree"
            )
        if self.decimal == "," and self.separator == ",":
            raise ValueError("separator and decimal sign cannot both be commas")
        return self

    @property
    def dialect(self) -> Dialect:
        """How the file is written."""
        return Dialect(self.separator, self.decimal, self.header_lines, self.encoding)


def read_mapping(path: Path) -> CsvMapping:
    """Read a mapping.

    Raises:
        ConfigError: the file is missing or no mapping; the fault is named with its key.
    """
    return read_described(CsvMapping, path)


def mapping_text(mapping: CsvMapping) -> str:
    """Return a mapping as TOML."""
    document = mapping.model_dump(exclude_none=True)
    columns = tomlkit.table()
    for name, one in document.pop("columns").items():
        columns.append(name, tomlkit.inline_table() | one)
    return tomlkit.dumps(document | {"columns": columns})


def read_mapped(path: Path, mapping: CsvMapping) -> Columns:
    """Read a recording by its mapping.

    Returns:
        Columns t_s and displacement_mm or angle_deg, as `tables.RECORDING` has them.

    Raises:
        UsageError: a cell is no number, or a column is missing; names file and line.
    """
    given = mapping.columns.given()
    found, lines = read_numbers(path, mapping.dialect, [one.column - 1 for one in given.values()])
    values = {
        name: one.sign * _UNITS[name][one.unit] * column
        for (name, one), column in zip(given.items(), found, strict=True)
    }
    if "t_s" not in values and mapping.rate_hz is not None:
        values = {"t_s": np.arange(lines.size) / mapping.rate_hz, **values}
    return Columns(values, lines)


def found_mapping(path: Path, rate_hz: float | None = None) -> CsvMapping:
    """Return a mapping as the headings and the first rows of a file suggest; a person has to look at it.

    Args:
        path: of the file.
        rate_hz: of a file without times.

    Raises:
        UsageError: no table of numbers begins in the file.
        ConfigError: a file of one column, and no rate.
    """
    dialect = found_dialect(path)
    lines = first_lines(path, dialect.codec, dialect.header_lines + 1)
    row = dialect.numbers(lines[-1]) or []
    headings = _headings(dialect, lines[:-1], len(row))
    if len(row) < 2 and rate_hz is None:
        raise ConfigError(f"{path}: has one column of numbers and no times: state its rate by --rate-hz")
    time = None if rate_hz is not None else _time_column(headings)
    value = next(place for place in range(len(row)) if place != time)
    unit = _unit_of(headings[value])
    angular = unit in _UNITS["angle_deg"]
    mapped = MappedColumn(
        column=value + 1, unit=unit if angular or unit in _UNITS["displacement_mm"] else "mm"
    )
    return CsvMapping(
        separator=dialect.separator,
        decimal=dialect.decimal,
        header_lines=dialect.header_lines,
        encoding=dialect.encoding,
        rate_hz=rate_hz,
        columns=MappedColumns(
            t_s=None if time is None else MappedColumn(column=time + 1, unit=_time_unit(headings[time])),
            displacement_mm=None if angular else mapped,
            angle_deg=mapped if angular else None,
        ),
    )


def _headings(dialect: Dialect, above: list[str], count: int) -> list[str]:
    """Return the headings of the columns, empty where there are none."""
    cells = next((dialect.cells(line) for line in reversed(above) if line.strip()), [])
    return cells if len(cells) == count else [""] * count


def _time_column(headings: list[str]) -> int:
    return next((place for place, heading in enumerate(headings) if _TIME_HEADING.match(heading)), 0)


def _time_unit(heading: str) -> str:
    unit = _unit_of(heading)
    return unit if unit in _UNITS["t_s"] else "s"


def _unit_of(heading: str) -> str:
    """Return the unit in a heading by the name that mappings have for it; empty where there is none."""
    found = _UNIT_IN_HEADING.search(heading)
    if found is None:
        return ""
    unit = (found[1] or found[2]).strip()
    for sign, name in _NAMED.items():
        unit = name if unit == sign else unit.replace(sign, name) if sign in "µμ" else unit
    return unit
