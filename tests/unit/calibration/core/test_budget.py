"""Draws of standard errors have mean 0, standard deviation 1 and their distribution's density."""

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.budget import Distribution, standard_draws


@pytest.mark.parametrize(
    ("distribution", "density"),
    [
        ("normal", stats.norm()),
        ("uniform", stats.uniform(-(3**0.5), 2 * 3**0.5)),
        ("triangular", stats.triang(0.5, -(6**0.5), 2 * 6**0.5)),
        ("arcsine", stats.arcsine(-(2**0.5), 2 * 2**0.5)),
    ],
)
def test_draws_follow_the_density(distribution: Distribution, density: stats.rv_continuous) -> None:
    draws = standard_draws(distribution, np.random.default_rng(2), 200_000)
    assert float(draws.mean()) == pytest.approx(0.0, abs=5.0 / 200_000**0.5)
    assert float(draws.std()) == pytest.approx(1.0, rel=0.01)
    low, high = density.support()
    assert low - 1e-12 <= draws.min()
    assert draws.max() <= high + 1e-12
    assert stats.kstest(draws[:20_000], density.cdf).pvalue > 1e-3
