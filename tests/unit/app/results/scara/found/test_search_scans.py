"""Scans of a search: a synthetic one with a known peak, its picture against that peak."""

from typing import Any, cast

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Level, Points
from catseye.app.results.scara.found import search
from catseye.app.store.reader import RunReader, StoredStep
from catseye.app.tui.widgets.figure_drawing import draw_figure
from tests.unit.procedures.benches import bench

PEAK_DEG = 31.4
HALF_DEG = 0.5


class Searched:
    """A run of a search whose signal is a bell about a known angle."""

    def __init__(self, *, found: bool = True) -> None:
        self.meta = {"procedure": "reflector-search"}
        j4_deg = np.concatenate([np.linspace(28.0, 34.0, 25), PEAK_DEG + np.linspace(-0.6, 0.6, 12)])
        signal = np.exp(-(((j4_deg - PEAK_DEG) / HALF_DEG) ** 2))
        self.looks = {
            "found": found,
            "reflector": "P1",
            "theta1_deg": -20.0,
            "theta2_deg": 40.0,
            "scan_j4_deg": j4_deg.tolist(),
            "scan_signal": (signal if found else np.zeros(j4_deg.size)).tolist(),
        }
        edges = {"lower_deg": PEAK_DEG - HALF_DEG, "j4_deg": PEAK_DEG, "upper_deg": PEAK_DEG + HALF_DEG}
        self._rows = [{"step_id": "sight/P1/00", **edges}] if found else []

    def steps(self) -> list[StoredStep]:
        old = {"found": True, "j4_deg": 1.0}
        steps = {"sight/P2/00": old, "sight/P1/00": self.looks}
        return [StoredStep(name, 1, name, "", "", 1, cast("Any", row)) for name, row in steps.items()]

    def rows(self, table: str) -> list[dict[str, Any]]:
        assert table == "search"
        return self._rows

    def result(self, _step: str) -> None:
        return None


def figure_of(run: object, monkeypatch: pytest.MonkeyPatch) -> Figure:
    monkeypatch.setattr(search, "bench_of", lambda cell: cell)
    monkeypatch.setattr(search, "cell_of_run", lambda _reader: bench())
    (found,) = search.searched_section(cast("RunReader", run)).blocks
    assert isinstance(found, Figure)
    return found


def test_the_peak_of_a_scan_is_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    figure = figure_of(Searched(), monkeypatch)
    (panel,) = (panel for row in figure.rows for panel in row if panel is not None)
    assert panel.title == "P1: J4 = 31.400° from θ1 -20°, θ2 40°"
    middle = [mark for mark in panel.marks if isinstance(mark, Level) and mark.label.startswith("middle")]
    assert [(mark.at, mark.vertical) for mark in middle] == [(PEAK_DEG, True)]
    (looks,) = (mark for mark in panel.marks if isinstance(mark, Points))
    assert looks.x[np.argmax(looks.y)] == pytest.approx(PEAK_DEG, abs=0.06)
    assert (np.diff(looks.x) >= 0.0).all()


def test_the_marker_stands_in_the_column_of_the_peak(monkeypatch: pytest.MonkeyPatch) -> None:
    columns = 100
    drawn = draw_figure(figure_of(Searched(), monkeypatch), columns, 24)
    texts = ["".join(text for text, _ in line) for line in drawn]
    first = next(number for number, text in enumerate(texts) if text.startswith("P1: J4")) + 1
    left = texts[first].index("│") if "│" in texts[first] else texts[first].index("┤")
    # The axis ends 4 % beyond the first and the last look, and fills the columns right of its line.
    low, high = 28.0 - 0.24, 34.0 + 0.24
    expected = left + 1 + (PEAK_DEG - low) / (high - low) * (columns - left - 2)
    places = []
    for line in drawn[first : first + 10]:
        column = 0
        for text, ink in line:
            places += [column + n for n in range(len(text)) if ink == "chosen" and text[n] != " "]
            column += len(text)
    assert places
    assert np.mean(places) == pytest.approx(expected, abs=1.0)


def test_a_scan_that_found_nothing_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    figure = figure_of(Searched(found=False), monkeypatch)
    (panel,) = (panel for row in figure.rows for panel in row if panel is not None)
    assert panel.title.startswith("P1: no return")
    assert not [mark for mark in panel.marks if isinstance(mark, Level) and mark.vertical]


def test_a_search_of_an_early_version_has_no_scans() -> None:
    run = Searched()
    run.looks.pop("scan_j4_deg")
    assert search.searched_section(cast("RunReader", run)).blocks == ()
