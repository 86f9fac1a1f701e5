"""Charts against geometry: where places, numbers and bars stand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.tui.widgets.chart import Chart, Frame, label_cells, marks, number
from catseye.calibration.core.types import Bools

FRAME = Frame("y", "deg")


@given(
    low=st.floats(-1e6, 1e6),
    span=st.floats(1e-3, 1e6),
    most=st.integers(1, 20),
)
@example(low=524288.78125, span=0.001, most=11)
def test_marks_are_round_inside_and_not_too_many(low: float, span: float, most: int) -> None:
    found = marks((low, low + span), most)
    assert found.size <= most + 1
    if found.size > 1:
        step = found[1] - found[0]
        assert step >= span / most * (1.0 - 1e-6)
        # The difference of two marks near 10⁶ is a step of 10⁻⁴ to a millionth only.
        mantissa = step / 10.0 ** np.floor(np.log10(step) + 1e-6)
        assert min(abs(mantissa - each) for each in (1.0, 2.0, 5.0)) < 1e-3
    assert np.all(found >= low - 1e-6 * span)
    assert np.all(found <= low + span * (1.0 + 1e-6))


@pytest.mark.parametrize(
    ("value", "step", "expected"),
    [
        (20.0, 10.0, "20"),
        (-0.5, 0.5, "−0.5"),
        (-1e-12, 0.1, "0"),
        (0.25, 0.05, "0.25"),
        (-100.0, 50.0, "−100"),
    ],
)
def test_numbers(value: float, step: float, expected: str) -> None:
    assert number(value, step) == expected


def test_corners_of_the_plot() -> None:
    chart = Chart(40, 13, (0.0, 100.0), (-10.0, 10.0), FRAME)
    lower, upper = chart.cell(0.0, -10.0), chart.cell(100.0, 10.0)
    # One line above for the title, two below for the axis and its numbers.
    assert (lower[1], upper[1]) == (10, 1)
    assert 37 <= upper[0] <= 39
    middle = chart.cell(50.0, 0.0)
    assert abs(middle[0] - (lower[0] + upper[0]) / 2) <= 1
    assert abs(middle[1] - 5.5) <= 0.5


def test_numbers_stand_at_their_heights() -> None:
    chart = Chart(40, 23, (0.0, 100.0), (-10.0, 10.0), FRAME)
    lines = chart.canvas.plain()
    for value in (-10, 0, 10):
        row = chart.cell(0.0, value)[1]
        assert lines[row].lstrip().startswith(f"{str(value).replace('-', '−')}┤")
    assert lines[-1].rstrip().endswith("deg")


def test_numbers_that_a_neighbour_has_take_no_room() -> None:
    chart = Chart(40, 23, (0.0, 100.0), (-10.0, 10.0), Frame(x_numbers=False, y_numbers=False))
    assert chart.plot_columns == 39
    assert chart.plot_rows == 21
    assert chart.left < label_cells((-10.0, 10.0), 21)


def test_equal_axes_draw_a_square_as_a_square() -> None:
    chart = Chart(70, 30, (0.0, 10.0), (0.0, 1.0), Frame(equal=True))
    across, down = chart.dot(np.array([2.0, 3.0]), np.array([0.0, 1.0]))
    assert across[1] - across[0] == pytest.approx(down[0] - down[1])
    assert chart.x == (0.0, 10.0)
    assert chart.y[0] < 0.0 < 1.0 < chart.y[1]


def test_places_of_cells_and_lattice_are_where_dots_are() -> None:
    chart = Chart(40, 13, (0.0, 100.0), (-10.0, 10.0), FRAME)
    x, y = chart.cells()
    for row, column in ((0, 0), (5, 17), (9, 30)):
        assert chart.cell(float(x[row, column]), float(y[row, column])) == (chart.left + column, 1 + row)
    across, down = chart.dot(*chart.lattice())
    assert np.allclose(across, np.rint(across))
    assert np.allclose(down, np.rint(down))


@given(
    x=st.lists(st.floats(-50.0, 150.0) | st.just(float("nan")), min_size=2, max_size=6),
    y=st.lists(st.floats(-50.0, 50.0) | st.just(float("nan")), min_size=6, max_size=6),
)
def test_polyline_sets_the_dots_of_its_straight_lines(x: list[float], y: list[float]) -> None:
    """A whole polyline against one line after the other, which is cut at the edges by itself."""
    whole, single = (Chart(40, 13, (0.0, 100.0), (-10.0, 10.0), FRAME).canvas for _ in range(2))
    places = list(zip(x, y, strict=False))
    whole.polyline(np.array(x), np.array(y[: len(x)]), "a")
    for start, end in pairwise(places):
        single.line(start, end, "a")
    # Where a line is cut, dots half-way between two may go either way.
    assert not np.any(whole.dots & ~widened(single.dots))
    assert not np.any(single.dots & ~widened(whole.dots))


def widened(dots: Bools) -> Bools:
    """Return dots with all their neighbours."""
    room = np.pad(dots, 1)
    rows, columns = dots.shape
    found: Bools = np.logical_or.reduce(
        [room[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    )
    return found


def test_powers_of_ten_stand_at_axes_of_logarithms() -> None:
    frame = Frame("y", x_decades=True, y_decades=True)
    chart = Chart(60, 23, (-4.0, -0.5), (-3.0, 0.0), frame)
    lines = chart.canvas.plain()
    for power, text in ((-3.0, "0.001"), (0.0, "1")):
        assert lines[chart.cell(-4.0, power)[1]].lstrip().startswith(f"{text}┤")
    assert {"0.0001", "0.001", "0.01", "0.1"} <= set(lines[-1].split())


def test_names_stand_below_their_places() -> None:
    chart = Chart(60, 12, (-0.5, 2.5), (0.0, 1.0), Frame("y", x_names=("+X", "−X", "+Y")))
    below = chart.canvas.plain()[-1]
    for place, name in enumerate(("+X", "−X", "+Y")):
        column = chart.cell(float(place), 0.0)[0]
        assert below[column - 1 : column + 1] == name


@pytest.mark.parametrize(("high", "expected"), [(2.0, [0.0, 1.0, 2.0]), (30.0, [0.0, 10.0, 20.0, 30.0])])
def test_counted_things_have_whole_numbers_at_their_axis(high: float, expected: list[float]) -> None:
    assert marks((0.0, high), 5, whole=True).tolist() == expected
