"""F-tests of nested models against the distributions that scipy knows as such."""

import pytest
from scipy import stats

from catseye.calibration.core.significance import chi2_probability, f_test, holm_factors


@pytest.mark.parametrize(("gain", "rank", "rest"), [(12.0, 3, 55.0), (0.0, 2, 40.0), (80.0, 1, 0.9)])
def test_probabilities_are_those_of_fs_distribution(gain: float, rank: int, rest: float) -> None:
    test = f_test(gain, rank, rest, 50)
    assert test.probability == pytest.approx(stats.f.sf(gain / rank / (rest / 50), rank, 50), rel=1e-9)
    assert test.scale == pytest.approx(rest / 50)


def test_a_sum_of_squares_has_the_chi_square_probability() -> None:
    assert chi2_probability(61.0, 50) == pytest.approx(stats.chi2.sf(61.0, 50), rel=1e-9)


def test_holms_factors_count_the_tests_that_are_left() -> None:
    # Holm 1979: the smallest of four times 4, the next times 3, and never less than the one before.
    assert holm_factors([0.02, 0.001, 0.3, 0.011]) == pytest.approx([2.0, 4.0, 1.0, 3.0])
    assert holm_factors([0.010, 0.011]) == pytest.approx([2.0, 0.020 / 0.011])
    assert holm_factors([0.0, 0.5]) == pytest.approx([2.0, 1.0])
