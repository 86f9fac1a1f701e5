"""The canvas against plane geometry, its characters against their Unicode names."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.tui.widgets.braille import Canvas
from tests.unit.app.tui.widgets.dots import dots_of

places = st.tuples(st.floats(0.0, 39.0), st.floats(0.0, 39.0))
far = st.floats(-1e300, 1e300)


@given(st.sets(st.tuples(st.integers(0, 39), st.integers(0, 39))))
def test_every_dot_is_where_unicode_says(points: set[tuple[int, int]]) -> None:
    canvas = Canvas(20, 10)
    if points:
        x, y = np.array(sorted(points), dtype=float).T
        canvas.points(x, y)
    assert dots_of(canvas.plain()) == points


@given(places, places)
def test_line_is_straight_and_has_no_holes(start: tuple[float, float], end: tuple[float, float]) -> None:
    canvas = Canvas(20, 10)
    canvas.line(start, end)
    dots = dots_of(canvas.plain())
    length = math.dist(start, end)
    for x, y in dots:
        across = (end[0] - start[0]) * (y - start[1]) - (end[1] - start[1]) * (x - start[0])
        aside = abs(across) / length if length > 1e-9 else math.dist((x, y), start)
        assert aside <= math.sqrt(0.5) + 1e-6
    reached = {min(dots)}
    while grown := {dot for dot in dots - reached if any(_touch(dot, other) for other in reached)}:
        reached |= grown
    assert reached == dots
    for place in (start, end):
        assert any(math.dist(place, dot) <= math.sqrt(0.5) + 1e-6 for dot in dots)


def _touch(one: tuple[int, int], other: tuple[int, int]) -> bool:
    return max(abs(one[0] - other[0]), abs(one[1] - other[1])) == 1


@given(far, far, far, far)
def test_what_lies_outside_is_not_drawn(x0: float, y0: float, x1: float, y1: float) -> None:
    canvas = Canvas(4, 3)
    canvas.line((x0, y0), (x1, y1))
    canvas.points(x0, y0)
    assert len(canvas.plain()) == 3


def test_a_line_from_far_away_crosses_at_the_same_place() -> None:
    canvas = Canvas(20, 10)
    canvas.line((-4000.0, -4000.0), (4000.0, 4000.0))
    assert dots_of(canvas.plain()) == {(each, each) for each in range(40)}


def test_circle_has_its_radius() -> None:
    canvas = Canvas(20, 10)
    canvas.circle((20.0, 20.0), 15.0)
    dots = dots_of(canvas.plain())
    assert all(abs(math.dist(dot, (20.0, 20.0)) - 15.0) <= math.sqrt(0.5) for dot in dots)
    assert {(35, 20), (20, 5), (5, 20), (20, 35)} <= dots


def test_arc_turns_counter_clockwise_from_the_right() -> None:
    canvas = Canvas(20, 10)
    canvas.arc((20.0, 20.0), 15.0, 0.0, math.pi / 2.0)
    dots = dots_of(canvas.plain())
    assert {(35, 20), (20, 5)} <= dots
    assert all(x >= 20 and y <= 20 for x, y in dots)


def test_dashes_leave_dots_out() -> None:
    canvas = Canvas(20, 1)
    canvas.line((0.0, 1.0), (39.0, 1.0), dash=3)
    assert {x for x, _ in dots_of(canvas.plain())} == {x for x in range(40) if x // 3 % 2 == 0}


def test_bars_fill_from_top_to_bottom_and_leave_gaps() -> None:
    canvas = Canvas(2, 2)
    canvas.bars(np.array([1.0, np.nan, 7.0, 0.0]), np.array([3.0, np.nan, 7.0, 7.0]))
    assert dots_of(canvas.plain()) == {(0, y) for y in (1, 2, 3)} | {(2, 7)} | {(3, y) for y in range(8)}


def test_letters_stand_above_dots_and_inks_come_with_their_cells() -> None:
    canvas = Canvas(4, 1)
    canvas.points(0.0, 0.0, "red")
    canvas.text(1, 0, "ab", "blue")
    canvas.text(3, 0, "cd", "blue")
    assert list(canvas.lines()) == [[("\u2801", "red"), ("abc", "blue")]]


@pytest.mark.parametrize("size", [(0, 0), (0, 5), (5, 0), (-3, 2)])
def test_no_room_is_no_error(size: tuple[int, int]) -> None:
    canvas = Canvas(*size)
    canvas.line((0.0, 0.0), (5.0, 5.0))
    assert "".join(canvas.plain()).strip() == ""
