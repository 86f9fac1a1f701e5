"""Charts against geometry: where places, numbers and bars stand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.tui.widgets.axis_scale import AxisKind
from catseye.app.tui.widgets.chart import Chart, Frame, left_cells
from catseye.calibration.core.types import Bools

FRAME = Frame("y", "deg")


def test_corners_of_the_plot() -> None:
    chart = Chart(40, 13, (0.0, 100.0), (-10.0, 10.0), FRAME)
    # One line above for the title, two below for the axis and its numbers.
    assert chart.cell(chart.x[0], chart.y[0]) == (chart.left, 10)
    assert chart.cell(chart.x[1], chart.y[1]) == (39, 1)
    lower, upper = chart.cell(0.0, -10.0), chart.cell(100.0, 10.0)
    middle = chart.cell(50.0, 0.0)
    assert abs(middle[0] - (lower[0] + upper[0]) / 2) <= 1
    assert abs(middle[1] - (lower[1] + upper[1]) / 2) <= 0.5


def test_numbers_stand_at_their_heights() -> None:
    chart = Chart(40, 23, (0.0, 100.0), (-10.0, 10.0), FRAME)
    lines = chart.canvas.plain()
    numbers = {row: line.partition("┤")[0].strip() for row, line in enumerate(lines) if "┤" in line}
    assert len(numbers) >= 3
    for row, text in numbers.items():
        assert chart.cell(0.0, float(text.replace("−", "-")))[1] == row
    assert lines[-2].endswith("deg")


def test_numbers_that_a_neighbour_has_take_no_room() -> None:
    chart = Chart(40, 23, (0.0, 100.0), (-10.0, 10.0), Frame(x_numbers=False, y_numbers=False))
    assert chart.plot_columns == 39
    assert chart.plot_rows == 21
    assert chart.left < left_cells((-10.0, 10.0), 21, FRAME)


def test_equal_axes_draw_a_square_as_a_square() -> None:
    chart = Chart(70, 30, (0.0, 10.0), (0.0, 1.0), Frame(equal=True))
    across, down = chart.dot(np.array([2.0, 3.0]), np.array([0.0, 1.0]))
    assert across[1] - across[0] == pytest.approx(down[0] - down[1])
    assert chart.x[0] <= 0.0 < 10.0 <= chart.x[1]
    assert chart.y[0] < 0.0 < 1.0 < chart.y[1]


@given(high=st.floats(1.0, 1e4), columns=st.integers(30, 90), rows=st.integers(12, 40))
def test_equal_axes_have_room_for_their_numbers(high: float, columns: int, rows: int) -> None:
    chart = Chart(columns, rows, (0.0, high), (0.0, 0.2 * high), Frame(equal=True))
    numbers = [line for line in chart.canvas.plain() if "┤" in line]
    assert {line.index("┤") for line in numbers} == {chart.left - 1}


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
    frame = Frame("y", x=AxisKind(decades=True), y=AxisKind(decades=True))
    chart = Chart(60, 23, (-4.0, -0.5), (-3.0, 0.0), frame)
    lines = chart.canvas.plain()
    for power, text in ((-3.0, "0.001"), (0.0, "1")):
        assert lines[chart.cell(-4.0, power)[1]].lstrip().startswith(f"{text}┤")
    assert {"0.0001", "0.001", "0.01", "0.1"} <= set(lines[-1].split())


def test_names_stand_below_their_places() -> None:
    chart = Chart(60, 12, (-0.5, 2.5), (0.0, 1.0), Frame("y", x=AxisKind(names=("+X", "−X", "+Y"))))
    below = chart.canvas.plain()[-1]
    for place, name in enumerate(("+X", "−X", "+Y")):
        column = chart.cell(float(place), 0.0)[0]
        assert below[column - 1 : column + 1] == name


@given(low=st.integers(-40, 40), span=st.integers(1, 60), slope=st.floats(-1.0, 1.0))
def test_line_over_the_plot_has_no_holes(low: int, span: int, slope: float) -> None:
    """Its ends stand at numbers, half-way between two dots."""
    chart = Chart(40, 13, (float(low), float(low + span)), (-10.0, 10.0), FRAME)
    places = np.array([float(low), float(low + span)])
    chart.line(places, slope * 10.0 * np.array([-1.0, 1.0]), "a")
    found = np.flatnonzero(chart.canvas.dots.any(axis=0))
    assert found.size == found[-1] - found[0] + 1
