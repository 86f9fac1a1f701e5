"""Figures drawn from data."""

from catseye.app.render.mpl import drawn
from catseye.app.render.palette import look_of
from catseye.app.results.figures import Role
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
