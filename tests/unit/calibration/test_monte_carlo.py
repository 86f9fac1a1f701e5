"""Monte Carlo propagation against the Jacobian's covariance."""

import numpy as np
import pytest

from calibration.identification import Identification, identify
from calibration.layout import ModelName
from calibration.uncertainty.budget import radial_motions
from calibration.uncertainty.monte_carlo import with_monte_carlo
from calibration.uncertainty.radial import RadialBudget
from tests.unit.calibration.paper import (
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    paper_points,
    random_truth,
)

DRAWS = 200
BUDGET = RadialBudget(0.005, 0.005, 0.010)


def identified(
    model: ModelName = "error-map", sigma_mm: float | None = 0.0156, radial: RadialBudget | None = None
) -> Identification:
    noise = np.random.default_rng(8).normal(0.0, 0.0156, 1056)
    points = paper_points(random_truth(8), noise_mm=noise, sigma_mm=sigma_mm)
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    budget = None if radial is None else radial_motions(radial)
    return identify(points, model, *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget)


def assert_agree(one: Identification, drawn: Identification) -> None:
    ratio = drawn.standard_uncertainty / one.standard_uncertainty
    # A standard deviation of 200 draws scatters by 1/sqrt(400) = 5 %.
    assert float(np.abs(ratio - 1.0).max()) < 0.2
    assert float(ratio.mean()) == pytest.approx(1.0, abs=0.05)
    u = one.standard_uncertainty
    correlation, own = one.covariance / np.outer(u, u), drawn.covariance / np.outer(u, u)
    assert float(np.sqrt(np.mean((correlation - own) ** 2))) < 0.1


def test_draws_agree_with_the_jacobian() -> None:
    one = identified()
    assert_agree(one, with_monte_carlo(one, DRAWS, 1))


def test_draws_agree_with_the_jacobian_when_no_uncertainty_is_stated() -> None:
    one = identified(sigma_mm=None)
    assert_agree(one, with_monte_carlo(one, DRAWS, 2))


def test_draws_agree_with_the_jacobian_for_the_conventional_model() -> None:
    one = identified("conventional")
    # The maps of the true arm are a misfit that widens both.
    assert one.fit.variance_factor > 2.0
    assert_agree(one, with_monte_carlo(one, DRAWS, 3))


def test_draws_agree_with_the_jacobian_when_radial_error_motions_are_stated() -> None:
    one = identified(radial=BUDGET)
    assert_agree(one, with_monte_carlo(one, DRAWS, 4))


def test_the_seed_decides_the_draws() -> None:
    one = identified("conventional")
    first, again, other = (with_monte_carlo(one, 20, seed) for seed in (5, 5, 6))
    assert np.array_equal(first.covariance, again.covariance)
    assert not np.array_equal(first.covariance, other.covariance)


def test_only_the_covariance_changes() -> None:
    one = identified("conventional")
    drawn = with_monte_carlo(one, 20, 7)
    assert np.array_equal(drawn.parameters, one.parameters)
    assert drawn.fit == one.fit
    assert drawn.covariance == pytest.approx(drawn.covariance.T)
