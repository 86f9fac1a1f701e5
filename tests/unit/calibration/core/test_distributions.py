"""Draws have the mean and the standard uncertainty that their distribution states, and keep its limits."""

import math

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.distributions import (
    Bounded,
    CurvilinearTrapezoid,
    Distribution,
    Normal,
    StudentT,
    Trapezoid,
)

DRAWS = 200_000

CASES: list[tuple[Distribution, float, float, float]] = [
    # Distribution, mean, standard deviation from its density, largest deviation from the mean.
    (Normal(3.0, 2.0), 3.0, 2.0, math.inf),
    (Bounded(1.0, 3.0, "uniform"), 1.0, math.sqrt(3.0), 3.0),
    (Bounded(1.0, 3.0, "triangular"), 1.0, 3.0 / math.sqrt(6.0), 3.0),
    (Bounded(-1.0, 2.0, "arcsine"), -1.0, math.sqrt(2.0), 2.0),
    (Trapezoid(-1.0, 3.0, 0.0), 1.0, 2.0 / math.sqrt(6.0), 2.0),
    (Trapezoid(-1.0, 3.0, 1.0), 1.0, 2.0 / math.sqrt(3.0), 2.0),
    (StudentT(5.0, 2.0, 8.0), 5.0, 2.0 * math.sqrt(8.0 / 6.0), math.inf),
    (CurvilinearTrapezoid(0.0, 1.0, 0.5), 0.0, math.sqrt(1.0 / 3.0 + 0.25 / 9.0), 1.5),
]


@pytest.mark.parametrize(("distribution", "mean", "u", "limit"), CASES)
def test_mean_scatter_and_limits(distribution: Distribution, mean: float, u: float, limit: float) -> None:
    draws = distribution.draw(np.random.default_rng(1), DRAWS)
    assert distribution.mean == mean
    assert distribution.u == pytest.approx(u)
    assert float(draws.mean()) == pytest.approx(mean, abs=5.0 * u / math.sqrt(DRAWS))
    assert float(draws.std()) == pytest.approx(u, rel=0.01)
    assert float(np.abs(draws - mean).max()) <= limit


@pytest.mark.parametrize(
    ("distribution", "reference"),
    [
        (Bounded(0.0, 1.0, "triangular"), stats.triang(0.5, -1.0, 2.0)),
        (Bounded(0.0, 1.0, "arcsine"), stats.arcsine(-1.0, 2.0)),
        (Trapezoid(0.0, 1.0, 0.5), stats.trapezoid(0.25, 0.75)),
        (StudentT(0.0, 1.0, 3.0), stats.t(3.0)),
    ],
)
def test_draws_follow_the_density(distribution: Distribution, reference: stats.rv_continuous) -> None:
    draws = distribution.draw(np.random.default_rng(2), 20_000)
    assert stats.kstest(draws, reference.cdf).pvalue > 1e-3


def test_two_degrees_of_freedom_have_no_standard_deviation() -> None:
    assert StudentT(0.0, 1.0, 2.0).u == math.inf
