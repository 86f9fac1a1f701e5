"""Scales of axes against plain arithmetic: where numbers stand, and what they say."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.tui.widgets.axis_scale import AxisKind, level_scale, marks, number, upright_scale
from catseye.app.tui.widgets.chart import Chart, Frame

spans = st.floats(1e-2, 1e5)
lows = st.floats(-1e4, 1e4)


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
        (2.5, 2.5, "2.5"),
        (0.075, 0.025, "0.075"),
        (-100.0, 50.0, "−100"),
    ],
)
def test_numbers(value: float, step: float, expected: str) -> None:
    assert number(value, step) == expected


@given(low=lows, span=spans, rows=st.integers(3, 60), columns=st.integers(40, 190))
def test_numbers_say_the_middles_of_their_cells(low: float, span: float, rows: int, columns: int) -> None:
    """What is read at a number is the value there: the cell is cut into dots by plain arithmetic."""
    kind = AxisKind()
    for scale, cells, dots in (
        (upright_scale((low, low + span), rows, kind), rows, 4),
        (level_scale((low, low + span), columns, kind), columns, 2),
    ):
        assert scale.ends[0] <= low + 1e-6 * span
        assert scale.ends[1] >= low + span * (1.0 - 1e-6)
        dot = (scale.ends[1] - scale.ends[0]) / (cells * dots - 1)
        middles = scale.ends[0] + dot * (dots * np.arange(cells) + 0.5 * (dots - 1))
        said = [float(text.replace("−", "-")) for text in scale.texts]
        assert len(said) == scale.marks.size >= 1
        for value in said:
            away = float(np.min(np.abs(middles - value))) / dot
            # A hundredth of a dot, and what a float of this size still tells apart.
            assert away < 0.01 + 1e-9 * abs(value) / dot or cells < 6, (scale, away)
            assert away <= 0.5 * dots + 0.01


@given(low=lows, span=spans, rows=st.integers(3, 60), columns=st.integers(10, 190))
def test_numbers_stand_in_the_nearest_cells(low: float, span: float, rows: int, columns: int) -> None:
    frame = Frame(title="y", x_label="x")
    chart = Chart(columns + 12, rows + 3, (0.0, 1.0), (low, low + span), frame)
    unit = (chart.y[1] - chart.y[0]) / (4 * chart.plot_rows - 1)
    for row, line in enumerate(chart.canvas.plain()):
        if (found := line.partition("┤"))[1]:
            value = float(found[0].replace("−", "-"))
            middle = chart.y[1] - unit * (4 * (row - 1) + 1.5)
            assert abs(value - middle) <= unit * (2.0 + 1e-6) + 1e-9 * abs(value)


@given(low=st.floats(-6.0, 6.0), span=st.floats(0.1, 8.0), rows=st.integers(6, 50))
def test_numbers_of_decades_are_round(low: float, span: float, rows: int) -> None:
    scale = upright_scale((low, low + span), rows, AxisKind(decades=True))
    assert scale.marks.size >= 2
    said = np.array([float(text) for text in scale.texts])
    np.testing.assert_allclose(np.log10(said), scale.marks, atol=1e-9)


def test_hundreds_at_decades_are_written_out() -> None:
    assert upright_scale((0.0, 3.0), 20, AxisKind(decades=True)).texts == ("1", "10", "100", "1000")


@pytest.mark.parametrize(("high", "expected"), [(2.0, [0.0, 1.0, 2.0]), (30.0, [0.0, 10.0, 20.0, 30.0])])
def test_counted_things_have_whole_numbers_at_their_axis(high: float, expected: list[float]) -> None:
    assert marks((0.0, high), 5, whole=True).tolist() == expected
    assert all(
        float(text).is_integer() for text in upright_scale((0.0, high), 12, AxisKind(whole=True)).texts
    )
