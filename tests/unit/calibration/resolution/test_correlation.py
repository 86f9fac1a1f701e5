"""Correlation of neighbours, against processes and sums that are written down here."""

import numpy as np
import pytest

from catseye.calibration.resolution.correlation import correlation_within, mean_variance_factor

WAY = np.repeat([1, -1], 10)
ALL = np.ones(20, dtype=np.bool_)


def test_independent_positions_cost_nothing() -> None:
    assert mean_variance_factor(0.0, 9) == 1.0


def test_positions_that_are_all_alike_count_as_one() -> None:
    assert mean_variance_factor(1.0, 9) == pytest.approx(9.0)


def test_the_factor_is_that_of_the_whole_covariance() -> None:
    places = np.arange(9)
    covariance = 0.4 ** np.abs(places[:, None] - places)
    assert mean_variance_factor(0.4, 9) == pytest.approx(covariance.sum() / 9.0)


def test_neighbours_across_a_reversal_do_not_count() -> None:
    left = np.zeros(20)
    left[9] = left[10] = 1.0
    assert correlation_within(left, WAY, ALL) == 0.0


def test_neighbours_that_are_left_out_do_not_count() -> None:
    left = np.zeros(20)
    left[3] = left[4] = left[15] = 1.0
    assert correlation_within(left, WAY, left == 0.0) == 0.0


def test_positions_that_alternate_cost_no_more_than_the_bound() -> None:
    assert correlation_within(np.tile([1.0, -1.0], 10), WAY, ALL) == -0.5


def test_a_known_correlation_is_found() -> None:
    rng = np.random.default_rng(3)
    found = []
    for _ in range(100):
        noise = rng.normal(size=(2, 11))
        found.append(correlation_within((noise[:, 1:] + noise[:, :-1]).ravel(), WAY, ALL))
    # A mean of two neighbours' noise correlates by half.
    assert np.mean(found) == pytest.approx(0.5, abs=0.06)
