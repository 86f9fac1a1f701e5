"""Mappings of recordings that other programs wrote: which of their columns are what, kept as a small TOML file."""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Final, Self

import numpy as np
from pydantic import model_validator

from catseye.app.cell.section import Positive
from catseye.app.errors import ConfigError
from catseye.app.files.mapped_table import read_mapped
from catseye.app.results.mapping import foreign_table, unit_of
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.mapping import LENGTHS, MappedColumn, MappedColumns, TableMapping

_DEG: Final = math.degrees(1.0)

_UNITS: Final[Mapping[str, Mapping[str, float]]] = {
    "t_s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "displacement_mm": LENGTHS,
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

_TIME_HEADING: Final = re.compile(r"\s*(t|time|zeit|temps|tempo)\b", re.IGNORECASE)


class RecordingColumns(MappedColumns):
    """Columns of the recording; displacements of the optics or angles."""

    units: ClassVar[Mapping[str, Mapping[str, float]]] = _UNITS
    t_s: MappedColumn | None = None
    displacement_mm: MappedColumn | None = None
    angle_deg: MappedColumn | None = None

    @model_validator(mode="after")
    def _are_a_recording(self) -> Self:
        if (self.displacement_mm is None) == (self.angle_deg is None):
            raise ValueError("state either displacement_mm or angle_deg")
        return self


class RecordingMapping(TableMapping):
    """A whole mapping file of a recording."""

    rate_hz: Positive | None = None
    columns: RecordingColumns

    @model_validator(mode="after")
    def _has_times(self) -> Self:
        if self.columns.t_s is None and self.rate_hz is None:
            raise ValueError(
                "state the column t_s, or rate_hz for a file without times; with both, they must agree"
            )
        return self


def read_mapped_recording(path: Path, mapping: RecordingMapping) -> Columns:
    """Read a recording by its mapping.

    Returns:
        Columns t_s and displacement_mm or angle_deg, as `tables.RECORDING` has them.

    Raises:
        UsageError: a cell is no number, or a column is missing; names file and line.
    """
    found = read_mapped(path, mapping)
    if "t_s" in found or mapping.rate_hz is None:
        return found
    return Columns({"t_s": np.arange(len(found)) / mapping.rate_hz, **found.values}, found.lines)


def found_mapping(path: Path, rate_hz: float | None = None) -> RecordingMapping:
    """Return a mapping as the headings and the first rows of a file suggest; a person has to look at it.

    Args:
        path: of the file.
        rate_hz: of a file without times.

    Raises:
        UsageError: no table of numbers begins in the file.
        ConfigError: a file of one column, and no rate.
    """
    table = foreign_table(path)
    dialect, headings = table.dialect, table.headings
    if len(table.row) < 2 and rate_hz is None:
        raise ConfigError(f"{path}: has one column of numbers and no times: state its rate by --rate-hz")
    time = None if rate_hz is not None else _time_column(headings)
    value = next(place for place in range(len(headings)) if place != time)
    unit = unit_of(headings[value])
    angular = unit in _UNITS["angle_deg"]
    mapped = MappedColumn(
        column=value + 1, unit=unit if angular or unit in _UNITS["displacement_mm"] else "mm"
    )
    return RecordingMapping(
        separator=dialect.separator,
        decimal=dialect.decimal,
        header_lines=dialect.header_lines,
        encoding=dialect.encoding,
        rate_hz=rate_hz,
        columns=RecordingColumns(
            t_s=None if time is None else MappedColumn(column=time + 1, unit=_time_unit(headings[time])),
            displacement_mm=None if angular else mapped,
            angle_deg=mapped if angular else None,
        ),
    )


def _time_column(headings: list[str]) -> int:
    return next((place for place, heading in enumerate(headings) if _TIME_HEADING.match(heading)), 0)


def _time_unit(heading: str) -> str:
    unit = unit_of(heading)
    return unit if unit in _UNITS["t_s"] else "s"
