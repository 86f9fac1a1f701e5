"""Pictures of alignments against made-up beams."""

import numpy as np
import pytest

from catseye.app.results.figures import Band, Line, Panel, Points
from catseye.app.results.scara.figures.alignment import HeightRound, TurnRound, heights_figure, turns_figure
from catseye.calibration.scara.alignment import fit_pitch

DISTANCE_MM = 400.0


def turned(number: int, offset_mm: float) -> TurnRound:
    """Return the exact lengths of a beam that passes the axis at an offset, each pass from a zero of its own."""
    turn = np.concatenate([np.linspace(-2.0, 2.0, 21), np.linspace(2.0, -2.0, 21)])
    angle, series = np.deg2rad(turn), np.repeat([0, 1], 21)
    length = DISTANCE_MM * np.cos(angle) + offset_mm * np.sin(angle) + np.where(series, 7.0, -3.0)
    return TurnRound(number, turn, length, series, offset_mm, -0.5 * DISTANCE_MM)


def panels_of(rows: tuple[tuple[Panel | None, ...], ...]) -> list[Panel]:
    return [panel for row in rows for panel in row if panel is not None]


def test_the_slope_that_is_left_is_the_offset() -> None:
    _, left = panels_of(turns_figure(turned(1, 0.7), turned(3, 0.05), 0.1).rows)
    points = {mark.label: mark for mark in left.marks if isinstance(mark, Points)}
    assert list(points) == ["round 1: +0.700 mm", "round 3: +0.050 mm"]
    for (label, mark), offset_mm in zip(points.items(), (0.7, 0.05), strict=True):
        slope = np.polyfit(np.deg2rad(mark.x), mark.y * 1e-3, 1)[0]
        assert slope == pytest.approx(offset_mm, abs=1e-3), label


def test_the_fit_runs_through_what_was_measured() -> None:
    measured, _ = panels_of(turns_figure(turned(2, 0.3), turned(2, 0.3), 0.1).rows)
    (fit,) = (mark for mark in measured.marks if isinstance(mark, Line))
    for mark in measured.marks:
        if isinstance(mark, Points):
            assert np.interp(mark.x, fit.x, fit.y) == pytest.approx(mark.y, abs=0.5)


def level(number: int, pitch_rad: float) -> HeightRound:
    distance = np.array([200.0, 450.0, 700.0])
    height = 50.0 - pitch_rad * distance
    return HeightRound(number, distance, height, fit_pitch(distance, height, 0.01), 0.01)


def test_heights_show_the_pitch_before_and_after() -> None:
    figure = heights_figure(level(1, 2e-3), level(2, 1e-4), 0.2)
    (panel,) = panels_of(figure.rows)
    labels = [mark.label for mark in panel.marks if isinstance(mark, Points)]
    assert [label.split(" ±")[0] for label in labels] == ["round 1: pitch +2.000", "round 2: pitch +0.100"]
    (band,) = (mark for mark in panel.marks if isinstance(mark, Band))
    # 0.2 mrad over the 250 mm from the middle to either end.
    assert band.high[-1] - band.low[-1] == pytest.approx(2 * 0.2e-3 * 250.0)
    last = level(2, 1e-4).j3_mm
    assert band.low[-1] <= last[-1] <= band.high[-1]
