"""Charts against geometry: where places, numbers and bars stand."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.tui.widgets.chart import Chart, ends_of, marks, number
from catseye.app.tui.widgets.inks import Line
from catseye.app.tui.widgets.result_charts import MapColumns, draw_layout, draw_map, draw_residuals


def text(lines: list[Line]) -> list[str]:
    return ["".join(piece for piece, _ in line) for line in lines]


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


def test_ends_hold_zero_and_every_finite_value() -> None:
    low, high = ends_of(np.array([3.0, np.nan]), np.array([7.0, np.inf]))
    assert low < 0.0 < 7.0 < high < 8.0


def test_corners_of_the_plot() -> None:
    chart = Chart(40, 13, (0.0, 100.0), (-10.0, 10.0), x_unit="deg", title="y")
    lower, upper = chart.cell(0.0, -10.0), chart.cell(100.0, 10.0)
    # One line above for the title, two below for the axis and its numbers.
    assert (lower[1], upper[1]) == (10, 1)
    assert 37 <= upper[0] <= 39
    middle = chart.cell(50.0, 0.0)
    assert abs(middle[0] - (lower[0] + upper[0]) / 2) <= 1
    assert abs(middle[1] - 5.5) <= 0.5


def test_numbers_stand_at_their_heights() -> None:
    chart = Chart(40, 23, (0.0, 100.0), (-10.0, 10.0), x_unit="deg", title="y")
    lines = chart.canvas.plain()
    for value in (-10, 0, 10):
        row = chart.cell(0.0, value)[1]
        assert lines[row].lstrip().startswith(f"{str(value).replace('-', '−')}┤")
    assert lines[-1].rstrip().endswith("deg")


def columns(positive: list[float], negative: list[float], u: float) -> MapColumns:
    node, none = np.array([-40.0, 0.0, 40.0]), np.full(3, u)
    return MapColumns("Δθ1 mdeg", node, np.array(positive), np.array(negative), none, none)


def test_signs_of_a_map_stand_at_the_values() -> None:
    lines = text(draw_map(columns([10.0, 20.0, 10.0], [-20.0, -10.0, -20.0], 0.0), 60, 24))
    rows = [row for row, line in enumerate(lines) if "+" in line]
    # 20 mdeg at the node in the middle, 10 at both ends, as far below as above.
    assert [lines[row].count("+") for row in rows] == [1, 2]
    middle = lines[rows[0]].index("+")
    ends = [lines[rows[1]].index("+"), lines[rows[1]].rindex("+")]
    assert abs(middle - sum(ends) / 2) <= 1
    # Behind the numbers of the axis, above those below.
    below = [row for row, line in enumerate(lines[1:-2], 1) for sign in line[4:] if sign == "−"]
    assert len(below) == 3
    assert below[0] < below[1] == below[2]


def test_both_directions_at_one_place() -> None:
    lines = text(draw_map(columns([5.0, 5.0, -5.0], [5.0, -5.0, 5.0], 0.0), 60, 24))
    assert sum(line.count("±") for line in lines) == 1


def test_bars_reach_twice_the_uncertainty_to_either_side() -> None:
    """Bars from −20 to 20 fill 40 of the 43.2 mdeg that the axis holds, and a part of a cell at both ends."""
    lines = text(draw_map(columns([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 10.0), 60, 24))
    column = next(line.rindex("±") for line in lines if line.count("±") == 3)
    rows = [row for row, line in enumerate(lines[1:-2], 1) if line[column] != " "]
    expected = (len(lines) - 3) * 40.0 / 43.2
    assert expected <= len(rows) <= expected + 2.0


def test_outliers_carry_their_numbers() -> None:
    values = np.zeros(40)
    values[6], values[30] = 60.0, -45.0
    lines = text(draw_residuals(values, ["P1"] * 20 + ["P2"] * 20, [7, 31], 80, 20))
    one = next((row, line.index("1")) for row, line in enumerate(lines[1:-2], 1) if "1" in line[6:])
    two = next((row, line.index("2", 6)) for row, line in enumerate(lines[1:-2], 1) if "2" in line[6:])
    assert one[0] < two[0]
    assert one[1] < 20 < 55 < two[1]
    assert lines[0].index("P1") < 40 < lines[0].index("P2") + 2


def test_layout_is_to_scale() -> None:
    """Two reflectors 500 mm apart stand five times as far apart as a bar of 100 mm is long."""
    places = [("A", 600.0, 250.0), ("B", 600.0, -250.0)]
    lines = text(draw_layout((325.0, 225.0), places, np.zeros((0, 2)), 70, 40))
    rows = [row for row, line in enumerate(lines) if "◆" in line]
    assert lines[rows[0]].index("◆") == lines[rows[1]].index("◆")
    bar = lines[-1]
    length_mm = float(bar.split()[1])
    cells = bar.index("┤") + 1
    # A cell is twice as high as wide.
    assert 2.0 * (rows[1] - rows[0]) / cells == pytest.approx(500.0 / length_mm, rel=0.15)


@pytest.mark.parametrize("size", [(0, 0), (1, 1), (5, 3), (9, 4), (12, 30)])
def test_no_room_is_no_fault(size: tuple[int, int]) -> None:
    draw_map(columns([1.0, 2.0, 3.0], [0.0, 0.0, 0.0], 1.0), *size)
    draw_residuals(np.zeros(3), ["P1"] * 3, [1], *size)
    draw_layout((325.0, 225.0), [("P1", 1.0, 2.0)], np.zeros((1, 2)), *size)
