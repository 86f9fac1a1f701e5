"""Measured Cartesian tests beside predictions of which an upper end alone is known."""

import pytest

from catseye.app.results.figures import Points
from catseye.app.results.model import Table
from catseye.app.results.resolution.cartesian_comparison import Compared, compared_steps, comparison_blocks
from catseye.app.results.resolution.figures.cartesian_steps import cartesian_step_figure
from tests.unit.app.results.resolution.sample import sample_prediction, sample_result


def minus_x(high: float | None) -> Compared:
    """Return −X at P1, measured as 0.020 mm, with no prediction but the upper end of its interval."""
    (least,) = (one for one in sample_prediction().least_steps if one.direction == "-X")
    bounded = least.model_copy(update={"low": 0.0, "high": high})
    compared = compared_steps([bounded], sample_result().tests)
    return next(one for one in compared if one.predicted is not None)


@pytest.mark.parametrize(("high", "inside"), [(0.0201, True), (0.0199, False), (None, None)])
def test_an_upper_end_alone_judges_the_measured_step(high: float | None, inside: bool | None) -> None:
    assert minus_x(high).inside is inside


def test_an_upper_end_alone_stands_in_the_table() -> None:
    (table,) = (block for block in comparison_blocks([minus_x(0.025)]) if isinstance(block, Table))
    assert table.rows == (("P1", "−X", "≤ 0.025", "0.020 (0.016 … 0.026)", "yes"),)


def test_an_upper_end_alone_is_not_drawn() -> None:
    figure = cartesian_step_figure([minus_x(0.025)])
    assert figure is not None
    ((panel,),) = figure.rows
    assert panel is not None
    assert {mark.label for mark in panel.marks if isinstance(mark, Points) and mark.label} == {"measured"}
