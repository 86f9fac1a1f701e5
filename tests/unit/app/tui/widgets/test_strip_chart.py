"""The strip against a plain search for extremes, and its axis against itself read back."""

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.tui.widgets.strip_chart import LABEL_WIDTH, Scale, draw, fold, next_scale
from tests.unit.app.tui.widgets.dots import dots_of

samples = st.lists(st.one_of(st.just(math.nan), st.floats(-1e3, 1e3)), min_size=1, max_size=300)


def by_hand(values: list[float], seen: int, per_dot: int, dots: int) -> tuple[list[float], list[float]]:
    """Sort each sample into its column by its number, and search the extremes."""
    columns: dict[int, list[float]] = {}
    for place, value in enumerate(values):
        number = seen - len(values) + place
        if not math.isnan(value):
            columns.setdefault(number // per_dot, []).append(value)
    last = (seen - 1) // per_dot
    shown = [columns.get(last - dots + 1 + column, []) for column in range(dots)]
    return [min(each, default=math.nan) for each in shown], [max(each, default=math.nan) for each in shown]


@given(samples, st.integers(0, 1000), st.integers(1, 20), st.integers(1, 60))
def test_every_column_has_its_extremes(values: list[float], before: int, per_dot: int, dots: int) -> None:
    seen = before + len(values)
    low, high = fold(np.array(values), np.array(values), seen, per_dot, dots)
    expected = by_hand(values, seen, per_dot, dots)
    np.testing.assert_array_equal(low, expected[0])
    np.testing.assert_array_equal(high, expected[1])


@given(st.integers(0, 99_999))
def test_a_spike_of_one_sample_among_many_is_drawn(place: int) -> None:
    values = np.zeros(100_000)
    values[place] = 1.0
    low, high = fold(values, values, 100_000, 1000, 100)
    scale = next_scale(None, float(low.min()), float(high.max()))
    assert scale is not None
    lines = [
        "".join(text for text, _ in line)[LABEL_WIDTH:]
        for line in draw(low, high, scale, 50 + LABEL_WIDTH, 8)
    ]
    top = round((scale.high - 1.0) / scale.span * 31)
    assert (place // 1000, top) in dots_of(lines)
    assert {x for x, y in dots_of(lines) if y == top} <= {place // 1000, place // 1000 + 1}


def test_columns_keep_their_samples_while_time_goes_on() -> None:
    values = np.random.default_rng(1).normal(size=1000)
    low, _ = fold(values[:900], values[:900], 900, 10, 50)
    later, _ = fold(values[:930], values[:930], 930, 10, 50)
    np.testing.assert_array_equal(low[3:], later[:-3])


def test_a_gap_stays_a_gap() -> None:
    values = np.ones(40)
    values[10:20] = np.nan
    low, high = fold(values, values, 40, 1, 40)
    scale = next_scale(None, 1.0, 1.0)
    assert scale is not None
    lines = [
        "".join(text for text, _ in line)[LABEL_WIDTH:]
        for line in draw(low, high, scale, 20 + LABEL_WIDTH, 4)
    ]
    assert {x for x, _ in dots_of(lines)} == set(range(40)) - set(range(10, 20))


def test_slow_samples_are_joined_and_a_pause_is_a_gap() -> None:
    """A sample in every fourth column of dots, none in columns 41 to 79."""
    low = np.full(120, np.nan)
    low[[*range(0, 41, 4), *range(80, 120, 4)]] = 1.0
    scale = next_scale(None, 1.0, 1.0)
    assert scale is not None
    lines = [
        "".join(text for text, _ in line)[LABEL_WIDTH:] for line in draw(low, low, scale, 60 + LABEL_WIDTH, 4)
    ]
    assert {x for x, _ in dots_of(lines)} == {*range(41), *range(80, 117)}


@given(st.floats(-1e4, 1e4), st.floats(0.0, 1e3))
def test_scale_holds_the_values_in_round_steps(low_mm: float, span_mm: float) -> None:
    high_mm = low_mm + span_mm
    scale = next_scale(None, low_mm, high_mm)
    assert scale is not None
    tiny = 1e-9 * max(1.0, abs(low_mm), abs(high_mm))
    assert scale.low <= low_mm + tiny
    assert scale.high >= high_mm - tiny
    mantissa = scale.step / 10.0 ** math.floor(math.log10(scale.step) + 1e-9)
    assert min(abs(mantissa - each) for each in (1.0, 2.0, 5.0, 10.0)) < 1e-6
    assert 2 <= round(scale.span / scale.step) <= 5
    assert next_scale(scale, low_mm, high_mm) == scale


def test_scale_grows_at_once_and_shrinks_late() -> None:
    wide = next_scale(None, 0.0, 0.9)
    assert wide == Scale(0.0, 1.0, 0.5)
    assert next_scale(wide, 0.3, 0.6) == wide
    assert next_scale(wide, 0.1, 1.1) != wide
    narrow = next_scale(wide, 0.50, 0.52)
    assert narrow is not None
    assert narrow.span < 0.1
    assert next_scale(wide, math.nan, math.nan) == wide
    assert next_scale(None, math.nan, math.nan) is None


@pytest.mark.parametrize(
    ("low_mm", "high_mm"),
    [
        (743.1203, 743.1278),
        (-0.0002, 0.0009),
        (-0.0098, -0.0095),
        (-0.3, 1.2),
        (-512.3, 88.0),
        (-3.1416, -3.1411),
    ],
)
def test_numbers_at_the_axis_are_the_values(low_mm: float, high_mm: float) -> None:
    scale = next_scale(None, low_mm, high_mm)
    assert scale is not None
    above = re.fullmatch(r"µm(?: above (-?[\d.]+) mm)?|mm", scale.title)
    assert above is not None
    base_mm = float(above[1] or 0.0)
    factor = 1.0 if scale.title == "mm" else 1e-3
    for value_mm in scale.marks():
        labelled_mm = base_mm + factor * float(scale.label(float(value_mm)))
        assert labelled_mm == pytest.approx(value_mm, abs=1e-3 * scale.step)


def test_numbers_stand_at_their_rows() -> None:
    lines = [
        "".join(text for text, _ in line)
        for line in draw(np.array([]), np.array([]), Scale(0.0, 2.0, 1.0), 20, 9)
    ]
    assert [line[:LABEL_WIDTH].strip("│┤ ") for line in lines] == ["2", "", "", "", "1", "", "", "", "0"]
