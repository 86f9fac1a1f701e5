"""How a recording of another program would be read: shown to a person before it is evaluated."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.results.mapping import doubted_units
from catseye.app.results.model import Report, Statement
from catseye.app.results.numbers import number
from catseye.app.results.preview import DIGITS, range_text, rows_report
from catseye.app.results.resolution.input_files import RecordingFile, recording_columns
from catseye.app.results.resolution.recording_mapping import RecordingMapping, found_mapping
from catseye.procedures.kit.columns import Columns


@dataclass(frozen=True)
class Preview:
    """How a recording is read.

    Attributes:
        mapping: given, or found in the file.
        columns: t_s and displacement_mm or angle_deg.
        doubt: about their units; None where the headings state them.
    """

    mapping: RecordingMapping
    columns: Columns
    doubt: Statement | None

    @property
    def rate_hz(self) -> float:
        """Samples a second, from the usual time between two of them; NaN of a single one."""
        steps = np.diff(self.columns["t_s"])
        return 1.0 / float(np.median(steps)) if steps.size and np.median(steps) else float("nan")


def preview(path: Path, mapping: RecordingMapping | None = None, rate_hz: float | None = None) -> Preview:
    """Read a recording by its mapping, or by the one that its headings suggest.

    Raises:
        UsageError: the file cannot be read so; names line and remedy.
    """
    mapping = mapping or found_mapping(path, rate_hz)
    columns = recording_columns(RecordingFile(path, mapping))
    return Preview(mapping, columns, doubted_units(path, mapping))


def preview_report(path: Path, shown: Preview) -> Report:
    """Return the first and the last rows as they are read, with rate and range."""
    columns = shown.columns
    value = next(name for name in columns.values if name != "t_s")
    entries = (
        ("samples", str(len(columns))),
        ("rate", f"{number(shown.rate_hz, DIGITS)} Hz"),
        ("range", range_text(columns[value])),
    )
    return rows_report(path, entries, shown.doubt, columns)
