"""The history of runs as rows: a long name never runs into the next column."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.store.history import RunLine
from catseye.app.tui.run_rows import cells, columns

LONG = RunLine(
    Path("runs/20260102T030405Z_tracker-calibration_abcdef"),
    "abcdef",
    "tracker-calibration",
    datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC),
    "complete",
    cell="a-cell-with-a-name-beyond-any-column",
)


@pytest.mark.parametrize("wide", [True, False])
def test_a_blank_parts_every_two_columns(wide: bool) -> None:
    row = [cell.plain for cell in cells(LONG, marked=True, wide=wide)]
    widths = [width for _, width in columns(wide=wide)]
    assert all(len(text) < width for text, width in zip(row, widths, strict=True))
    assert row[2] == "tracker-calibra…"
    assert row[-2].endswith("…")
    assert row[-1] == "abcdef"
