"""Arrivals from above against places by hand."""

import numpy as np
import pytest

from catseye.app.results.figures import Points, Shape
from catseye.app.results.scara.figures.arrivals import Seen, arrivals_from_above

UP = Seen(1, "P1", np.pi / 2, np.array([2.0, -2.0]))
RIGHT = Seen(1, "P2", 0.0, np.array([5.0, -1.0, -4.0]))


def test_an_arrival_lies_on_the_line_of_its_beam() -> None:
    # The reflector is above: two micrometres more to it are two further down.
    assert UP.place_um == pytest.approx(np.array([[0.0, -2.0], [0.0, 2.0]]), abs=1e-9)
    assert RIGHT.place_um == pytest.approx(np.array([[-5.0, 0.0], [1.0, 0.0], [4.0, 0.0]]), abs=1e-9)


def test_the_ellipse_has_three_standard_deviations() -> None:
    figure = arrivals_from_above([UP, RIGHT], {1: np.diag([16.0, 4.0])})
    ((panel,),) = figure.rows
    assert panel is not None
    (ellipse,) = (mark for mark in panel.marks if isinstance(mark, Shape))
    # The short axis first: it lies along y.
    assert ellipse.half == pytest.approx((6.0, 12.0))
    assert abs(ellipse.turn_deg) == pytest.approx(90.0)
    assert panel.x.high is not None
    assert panel.x.high > 12.0


def test_without_an_ellipse_the_arrivals_alone_are_drawn() -> None:
    figure = arrivals_from_above([UP, RIGHT, Seen(2, "P1", 0.0, np.array([1.0, -1.0]))], {})
    panels = [panel for row in figure.rows for panel in row if panel is not None]
    assert [panel.title for panel in panels] == ["pose 1", "pose 2"]
    labels = [mark.label for mark in panels[0].marks if isinstance(mark, Points)]
    assert labels == ["to P1", "to P2"]
