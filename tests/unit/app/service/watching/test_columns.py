"""Columns hold the extremes of their samples, and the spread is that of the samples of the last second."""

import statistics
from itertools import accumulate

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.service.watching.columns import Columns

SAMPLES = st.lists(
    st.tuples(st.integers(0, 120), st.floats(-1000.0, 1000.0, allow_subnormal=False)), max_size=60
)
"""Time since the sample before, ms; value."""


@given(SAMPLES)
@example([(115, 0.0)])
def test_every_sample_is_in_the_column_of_its_time(samples: list[tuple[int, float]]) -> None:
    columns = Columns()
    times_ms = list(accumulate((gap for gap, _ in samples), initial=5))[1:]
    for time_ms, (_, value) in zip(times_ms, samples, strict=True):
        columns.add(value, time_ms / 1000.0 + 1e-6)
    if not times_ms:
        assert columns.take(7.0).count == []
        return
    # A microsecond behind the end of the last column, as the samples are behind their milliseconds.
    taken = columns.take(times_ms[-1] / 1000.0 + 0.02 + 1e-6)
    first = times_ms[0] // 20
    expected: dict[int, list[float]] = {number: [] for number in range(first, times_ms[-1] // 20 + 1)}
    for time_ms, (_, value) in zip(times_ms, samples, strict=True):
        expected[time_ms // 20].append(value)
    assert taken.count == [len(values) for values in expected.values()]
    assert taken.low == [min(values, default=None) for values in expected.values()]
    assert taken.high == [max(values, default=None) for values in expected.values()]
    assert taken.missed == 0


@given(st.lists(st.floats(-1e-3, 1e-3), min_size=3, max_size=40), st.floats(-1000.0, 1000.0))
def test_mean_and_spread_are_exact_at_any_beam_length(values: list[float], beam_mm: float) -> None:
    columns = Columns()
    lengths_mm = [beam_mm + value for value in values]
    for number, length_mm in enumerate(lengths_mm):
        columns.add(length_mm, 0.02 * number + 0.01)
    assert columns.spread() == pytest.approx(statistics.stdev(lengths_mm), rel=1e-6, abs=1e-12)
    assert columns.mean() == pytest.approx(statistics.fmean(lengths_mm), abs=1e-9)


def test_the_spread_needs_three_samples_within_a_second() -> None:
    columns = Columns()
    for number in range(10):
        columns.add(100.0 * number, 0.01 * number)
    columns.take(1.2)
    assert columns.spread() is None
    assert columns.mean() is None
    for number in range(3):
        columns.add(float(number), 1.2 + 0.1 * number)
    assert columns.spread() == pytest.approx(1.0)


def test_what_nobody_takes_is_bounded_and_counted() -> None:
    columns = Columns(most=100)
    for number in range(250):
        columns.add(float(number), 0.02 * number + 0.01)
    taken = columns.take(0.02 * 250)
    assert (taken.low, taken.missed) == ([float(number) for number in range(150, 250)], 150)
    again = columns.take(0.02 * 1250)
    # The column that was open, then a thousand without a sample.
    assert (len(again.count), again.missed) == (100, 900)
    assert set(again.low) == {None}


def test_a_time_that_has_been_taken_is_not_taken_again() -> None:
    columns = Columns()
    columns.add(1.0, 0.001)
    assert columns.take(0.019).count == []
    assert columns.take(0.021).count == [1]
    columns.add(2.0, 0.021)
    assert columns.take(0.021).count == []
    assert columns.take(0.041).low == [2.0]
