"""Joint coverage regions of several results against closed forms of the normal distribution (JCGM 102)."""

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.uncertainty.joint_regions import joint_regions

DRAWS = 200_000


def drawn(covariance: list[list[float]], seed: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    rng = np.random.default_rng(seed)
    return rng.multivariate_normal(np.arange(float(len(covariance))), covariance, DRAWS)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_factors_of_independent_normal_results(size: int) -> None:
    found = joint_regions(drawn(np.diag([1.0, 4.0, 0.25][:size]).tolist(), 1))
    # For two results the well known 2.45 and 2.24, for three 2.80 and 2.39.
    assert found.elliptical == pytest.approx(float(np.sqrt(stats.chi2.ppf(0.95, size))), rel=0.005)
    assert found.rectangular == pytest.approx(stats.norm.ppf(0.5 + 0.5 * 0.95 ** (1.0 / size)), rel=0.005)


def test_correlation_narrows_the_box_and_leaves_the_ellipse() -> None:
    found = joint_regions(drawn([[2.0, 1.9], [1.9, 2.0]], 2))
    assert found.correlation[0, 1] == pytest.approx(0.95, abs=0.002)
    assert found.u == pytest.approx([2.0**0.5] * 2, rel=0.005)
    assert found.elliptical == pytest.approx(2.448, rel=0.005)
    # Of fully correlated results the box would be that of one result, 1.96.
    assert 1.96 < found.rectangular < 2.236


def test_regions_hold_their_share_of_new_results() -> None:
    covariance = [[2.0, -0.8, 0.1], [-0.8, 1.0, 0.3], [0.1, 0.3, 4.0]]
    found, fresh = joint_regions(drawn(covariance, 3), 0.9), drawn(covariance, 4)
    assert float(found.in_ellipsoid(fresh).mean()) == pytest.approx(0.9, abs=0.004)
    assert float(found.in_box(fresh).mean()) == pytest.approx(0.9, abs=0.004)
    assert found.mean == pytest.approx([0.0, 1.0, 2.0], abs=0.02)
