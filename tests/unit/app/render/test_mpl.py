"""Figures drawn from data."""

import numpy as np
from matplotlib.collections import LineCollection

from catseye.app.render.mpl import drawn
from catseye.app.render.palette import look_of
from catseye.app.results.figures import Axis, Bars, Figure, Line, Panel, Points, Role
from tests.unit.app.render.reports import FIGURE


def test_every_role_has_a_look() -> None:
    assert all(look_of(role).colour.startswith("#") for role in Role)
    assert look_of(6) == look_of(0)


def test_every_mark_is_drawn_and_labels_stand_in_one_legend() -> None:
    figure = drawn(FIGURE)
    (legend,) = figure.legends
    texts = {text.get_text() for text in legend.get_texts()}
    assert texts == {"a line", "points", "a reflector", "a band", "a span", "a circle"}
    # Three panels; a scale of colours for each row that has one.
    assert len(figure.axes) == 5
    assert figure.axes[0].get_ylabel() == "$E_{YY}$ / y"


def test_panels_share_scales_that_hold_all_their_marks() -> None:
    figure = drawn(FIGURE)
    upper, left, right = figure.axes[:3]
    assert upper.get_xlim() == left.get_xlim()
    assert left.get_ylim() == right.get_ylim()
    assert right.get_ylim()[1] >= 6.0


def test_powers_of_ten_stand_at_an_axis_of_logarithms() -> None:
    line = Line(np.array([-4.0, -1.0]), np.array([0.0, 1.0]), Role.PATH)
    panel = Panel("", Axis("step", low=-4.2, high=-0.8, decades=True), Axis("y"), (line,))
    figure = drawn(Figure("f", "f", "", ((panel,),)))
    figure.canvas.draw()
    axis = figure.axes[0].xaxis
    low, high = axis.get_view_interval()
    texts = {
        text.get_text()
        for at, text in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=True)
        if low <= at <= high
    }
    assert texts == {"0.0001", "0.001", "0.01", "0.1"}
    assert np.log10(0.002) in axis.get_minorticklocs()


def test_names_stand_at_an_axis_in_place_of_numbers() -> None:
    line = Line(np.array([0.0, 2.0]), np.array([0.0, 1.0]), Role.PATH)
    panel = Panel("", Axis("direction", low=-0.5, high=2.5, names=("+X", "−X", "+Y")), Axis("y"), (line,))
    axis = drawn(Figure("f", "f", "", ((panel,),))).axes[0].xaxis
    texts = [text.get_text() for text in axis.get_majorticklabels()]
    assert dict(zip(axis.get_majorticklocs().tolist(), texts, strict=True)) == {
        0.0: "+X",
        1.0: "−X",
        2.0: "+Y",
    }


BARS = Bars(np.array([0.0, 1.0, 2.0]), np.array([2.0, 1.0]), Role.SCATTER)


def test_counted_things_have_whole_numbers_at_their_axis() -> None:
    # Of 20 measurements: marks would stand at 2.5 and 7.5 else.
    line = Line(np.arange(1.0, 21.0), np.zeros(20), Role.PATH)
    panel = Panel("", Axis("measurement", counts=True), Axis("y"), (line,))
    marks = drawn(Figure("f", "f", "", ((panel,),), aspect=0.2)).axes[0].xaxis.get_majorticklocs()
    assert [float(mark) for mark in marks if mark != round(mark)] == []


def test_a_histogram_has_whole_numbers_upwards() -> None:
    panel = Panel("", Axis("error / mm"), Axis("measurements"), (BARS,))
    marks = drawn(Figure("f", "f", "", ((panel,),), aspect=0.5)).axes[0].yaxis.get_majorticklocs()
    assert [float(mark) for mark in marks if mark != round(mark)] == []


def test_error_bars_reach_twice_their_standard_uncertainty() -> None:
    points = Points(np.array([1.0]), np.array([5.0]), Role.CHANGE, u=np.array([0.5]))
    axes = drawn(Figure("f", "f", "", ((Panel("", Axis("x"), Axis("y"), (points,)),),))).axes[0]
    (bars,) = [one for one in axes.collections if isinstance(one, LineCollection)]
    (ends,) = bars.get_segments()
    assert ends[:, 1].tolist() == [4.0, 6.0]
