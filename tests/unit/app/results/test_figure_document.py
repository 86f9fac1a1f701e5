"""Figures as JSON and back."""

import json

import numpy as np
import pytest

from catseye.app.results.figure_document import figures_json, figures_of
from catseye.app.results.figures import Axis, Figure, Line, Panel, Role
from tests.unit.app.render.reports import FIGURE


def test_figures_are_the_same_after_json() -> None:
    document = figures_json([FIGURE, FIGURE])
    again = figures_of(json.loads(json.dumps(document, allow_nan=False)))
    assert figures_json(again) == document
    assert again[0].rows[0][0] is not None
    assert [type(mark) for mark in again[0].rows[0][0].marks] == [
        type(mark) for panel in FIGURE.rows[0][:1] if panel for mark in panel.marks
    ]


def test_gaps_and_inks_come_back_as_they_were() -> None:
    x = np.array([0.0, np.nan, 2.0])
    marks = (Line(x, x, Role.TRUTH), Line(x, x, 3))
    (again,) = figures_of(figures_json([Figure("key", "", "", ((Panel("", Axis(), Axis(), marks),),))]))
    panel = again.rows[0][0]
    assert panel is not None
    first, second = panel.marks
    assert isinstance(first, Line)
    assert isinstance(second, Line)
    assert first.ink is Role.TRUTH
    assert second.ink == 3
    assert np.array_equal(first.x, x, equal_nan=True)


def test_unknown_kind_is_refused() -> None:
    with pytest.raises(ValueError, match="no figure"):
        figures_of([{"kind": "pie"}])
