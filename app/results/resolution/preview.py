"""How a recording of another program would be read: shown to a person before it is evaluated."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.results.model import Column, Entries, Report, Table, section
from catseye.app.results.numbers import COUNT, Format, number
from catseye.app.results.origin import origin_now
from catseye.app.results.resolution.csv_mapping import CsvMapping, found_mapping
from catseye.app.results.resolution.input_files import RecordingFile, recording_columns
from catseye.procedures.kit.columns import Columns

_SHOWN: Final = 5
"""Rows of the beginning, and as many of the end."""

_DIGITS: Final = Format("significant", 6)


@dataclass(frozen=True)
class Preview:
    """How a recording is read.

    Attributes:
        mapping: given, or found in the file.
        columns: t_s and displacement_mm or angle_deg.
    """

    mapping: CsvMapping
    columns: Columns

    @property
    def rate_hz(self) -> float:
        """Samples a second, from the usual time between two of them; NaN of a single one."""
        steps = np.diff(self.columns["t_s"])
        return 1.0 / float(np.median(steps)) if steps.size and np.median(steps) else float("nan")


def preview(path: Path, mapping: CsvMapping | None = None, rate_hz: float | None = None) -> Preview:
    """Read a recording by its mapping, or by the one that its headings suggest.

    Raises:
        UsageError: the file cannot be read so; names line and remedy.
    """
    mapping = mapping or found_mapping(path, rate_hz)
    return Preview(mapping, recording_columns(RecordingFile(path, mapping)))


def preview_report(path: Path, shown: Preview) -> Report:
    """Return the first and the last rows as they are read, with rate and range."""
    columns = shown.columns
    value = next(name for name in columns.values if name != "t_s")
    rows = np.unique(np.r_[0 : min(_SHOWN, len(columns)), max(len(columns) - _SHOWN, 0) : len(columns)])
    table = Table(
        "rows",
        "As it is read",
        (
            Column("line", "line", format=COUNT),
            Column("t_s", "t_s", format=_DIGITS),
            Column(value, value, format=_DIGITS),
        ),
        tuple(
            (int(columns.lines[row]), float(columns["t_s"][row]), float(columns[value][row]))
            for row in rows.tolist()
        ),
    )
    entries = Entries(
        (
            ("samples", str(len(columns))),
            ("rate", f"{number(shown.rate_hz, _DIGITS)} Hz"),
            (
                "range",
                f"{number(float(columns[value].min()), _DIGITS)} … {number(float(columns[value].max()), _DIGITS)}",
            ),
        )
    )
    return Report(
        f"Preview of {path.name}",
        origin_now(),
        (section("preview", path.name, [entries, table], brief=True),),
    )
