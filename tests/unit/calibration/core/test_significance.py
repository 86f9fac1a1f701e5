"""F-tests of nested models against the distributions that scipy knows as such."""

import pytest
from scipy import stats

from catseye.calibration.core.significance import Expected, f_test


@pytest.mark.parametrize(("gain", "rank", "rest"), [(12.0, 3, 55.0), (0.0, 2, 40.0), (80.0, 1, 0.9)])
def test_probabilities_are_those_of_fs_distribution(gain: float, rank: int, rest: float) -> None:
    expected, left = Expected(2.0 * rank, 1.5 * rank), Expected(70.0, 33.3)
    test = f_test(gain, expected, rank, rest, left, 50)
    assert test.probability == pytest.approx(stats.f.sf(gain / rank / (rest / 50), rank, 50), rel=1e-9)
    stated = gain / expected.mean / (rest / left.mean)
    assert test.probability_stated == pytest.approx(stats.f.sf(stated, expected.dof, left.dof), rel=1e-9)


def test_a_negative_expected_gain_is_not_significant() -> None:
    """Large systematic effects, projected at two fits, may leave a difference below zero."""
    test = f_test(3.0, Expected(-0.5, 0.1), 2, 50.0, Expected(50.0, 40.0), 50)
    assert test.probability_stated == 1.0
