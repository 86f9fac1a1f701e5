"""LOWESS against local fits one at a time, by the general solver."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.lowess import half_window, lowess, velocity


def local_fits(values: Floats, half: int) -> Floats:
    """Fit a weighted line to the nearest neighbours of each sample."""
    places = np.arange(values.size, dtype=np.float64)
    found = np.empty(values.size)
    for centre in range(values.size):
        near = np.argsort(np.abs(places - centre), kind="stable")[: 2 * half + 1]
        away = places[near] - centre
        root = np.sqrt((1.0 - (np.abs(away) / np.abs(away).max()) ** 3) ** 3)
        design = np.column_stack([np.ones(near.size), away]) * root[:, None]
        found[centre] = np.linalg.lstsq(design, root * values[near], rcond=None)[0][0]
    return found


@given(st.integers(2, 25), st.integers(0, 60), st.integers(0, 2**32 - 1))
def test_it_equals_local_fits_everywhere(half: int, more: int, seed: int) -> None:
    values = np.random.default_rng(seed).normal(3.0, 1.0, 2 * half + 1 + more).cumsum()
    assert np.abs(lowess(values, half) - local_fits(values, half)).max() < 1e-10


def test_lines_stay_as_they_are() -> None:
    line = 1e6 + 0.25 * np.arange(1000.0)
    assert np.abs(lowess(line, 50) - line).max() < 1e-8


def test_the_window_is_half_a_second_at_any_rate() -> None:
    assert [half_window(rate) for rate in (20.0, 100.0, 1000.0)] == [5, 25, 250]
    assert half_window(4.0) == 2


def test_a_constant_speed_is_found() -> None:
    assert velocity(0.3 * np.arange(0.0, 5.0, 0.01), 100.0) == pytest.approx(0.3)


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="20 samples are fewer than the 21"):
        lowess(np.zeros(20), 10)
