"""Deviations along a path before there is any model: an instrument that stands askew sees those that were put in."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Panel, Points
from catseye.app.results.scara.figures.measured_path import NO_RESULT, measured_path_figure
from catseye.app.results.scara.validation import FEWEST_ROWS, PathMeasurement
from catseye.calibration.core.types import Floats
from tests.unit.app.results.scara import sample

ANGLE = np.radians(27.0)
SHIFT_MM = np.array([812.5, -44.25])


def seen_askew(position_mm: Floats) -> Floats:
    """Return positions in the frame of an instrument that is turned and stands elsewhere."""
    turn = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
    return np.asarray(position_mm @ turn.T + SHIFT_MM)


def bent(path: PathMeasurement) -> tuple[Floats, Floats]:
    """Return deviations along X of a straight path along Y, µm, as no rigid motion makes them; and where.

    What a straight line, or a shift along the path, could take away is taken away by hand.
    """
    y_mm = path.command_mm[:, 1]
    bow = 20.0 * np.cos(3.0 * np.pi * (y_mm - y_mm.min()) / np.ptp(y_mm))
    slope, level = np.polyfit(y_mm - y_mm.mean(), bow, 1)
    return np.asarray(bow - level - slope * (y_mm - y_mm.mean())), y_mm


def panels_of(figure: Figure | None) -> list[Panel]:
    assert figure is not None
    return [panel for row in figure.rows for panel in row if panel is not None]


def drawn(panel: Panel) -> dict[float, list[float]]:
    """Return the deviations, µm, by their place, mm."""
    found: dict[float, list[float]] = {}
    for points in (mark for mark in panel.marks if isinstance(mark, Points)):
        for x, y in zip(np.asarray(points.x), np.asarray(points.y), strict=True):
            found.setdefault(float(x), []).append(float(y))
    return found


def test_deviations_put_in_are_drawn_wherever_the_instrument_stands() -> None:
    path = sample.path("y")
    bow_um, y_mm = bent(path)
    where_mm = path.command_mm + 1e-3 * np.column_stack([bow_um, np.zeros_like(bow_um)])
    along, across = panels_of(
        measured_path_figure(replace(path, measured_mm=seen_askew(where_mm)), NO_RESULT)
    )
    assert (along.y.symbol, across.y.symbol) == ("E_{YY}", "E_{XY}")
    for place, bow in zip(y_mm, bow_um, strict=True):
        assert drawn(across)[float(place)] == pytest.approx(
            [bow] * len(drawn(across)[float(place)]), abs=0.05
        )
        assert drawn(along)[float(place)] == pytest.approx([0.0] * len(drawn(along)[float(place)]), abs=0.05)


def test_way_there_and_back_are_told_apart() -> None:
    path = sample.path("y")
    (along, _) = panels_of(
        measured_path_figure(replace(path, measured_mm=seen_askew(path.command_mm)), NO_RESULT)
    )
    labels = {mark.label: len(np.asarray(mark.x)) for mark in along.marks if isinstance(mark, Points)}
    assert labels == {"way there": int((path.travel > 0).sum()), "way back": int((path.travel < 0).sum())}


@pytest.mark.parametrize("known", [0, FEWEST_ROWS - 1, FEWEST_ROWS])
def test_too_few_positions_are_no_figure(known: int) -> None:
    path = sample.path("y")
    measured_mm = seen_askew(path.command_mm)
    measured_mm[known:] = np.nan
    figure = measured_path_figure(replace(path, measured_mm=measured_mm), NO_RESULT)
    assert (figure is None) == (known < FEWEST_ROWS)
