"""Monte Carlo of an identification against the law of propagation, its seeds and its refusals."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.draws import CHUNK, joined, solve_chunk
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.uncertainty import chunks, with_draws
from tests.unit.calibration.scara.samples import TERMS, identified, noisy_points

DRAWS = 3000

BUDGET = Budget(
    (
        Contributor("repeatability", "length", 0.015),
        Contributor("resolution", "length", 0.004, distribution="uniform"),
        Contributor("arrival", "position", 0.004, "pose"),
        Contributor("wavelength", "scale", 2e-6, "common", distribution="arcsine"),
        Contributor("encoder", "angle", 2e-5, "axis-angle", "j2"),
        Contributor("radial motion", "radial", 0.005, "axis-angle", "j4"),
    )
)


def drawn(one: Identification, draws: int = DRAWS, seed: int = 1) -> Identification:
    return with_draws(one, joined([solve_chunk(each) for each in chunks(one, draws, seed)]).parameters)


def assert_agree(one: Identification) -> None:
    found = drawn(one)
    ratio = found.standard_uncertainty / one.standard_uncertainty
    # A standard deviation of 3000 draws scatters by 1/sqrt(6000) = 1.3 %.
    assert float(np.abs(ratio - 1.0).max()) < 0.055
    assert float(ratio.mean()) == pytest.approx(1.0, abs=0.015)
    u = one.standard_uncertainty
    # A correlation scatters by 1/sqrt(3000) = 1.8 % at most, a variance by 2.6 %.
    assert float(np.sqrt(np.mean(((found.covariance - one.covariance) / np.outer(u, u)) ** 2))) < 0.025


def test_draws_agree_with_the_jacobian() -> None:
    assert_agree(identified())


def test_draws_agree_with_the_jacobian_when_no_uncertainty_is_stated() -> None:
    assert_agree(identified(noisy_points(sigma_mm=None)))


def test_draws_agree_with_the_jacobian_for_the_conventional_model() -> None:
    one = identified(model="conventional")
    # The maps of the true arm are a misfit that widens both.
    assert one.fit.variance_ratio > 2.0
    assert_agree(one)


def test_draws_agree_with_the_jacobian_for_every_correlation() -> None:
    assert_agree(identified(noisy_points(sigma_mm=None), budget=BUDGET))


def test_draws_agree_with_the_jacobian_for_terms_beyond_the_maps() -> None:
    assert_agree(identified(terms=TERMS))


def test_the_seed_decides_the_draws() -> None:
    one = identified(model="conventional")
    first, again, other = (drawn(one, 600, seed) for seed in (5, 5, 6))
    assert np.array_equal(first.covariance, again.covariance)
    assert not np.array_equal(first.covariance, other.covariance)


def test_more_draws_begin_with_the_same_ones() -> None:
    one = identified(model="conventional")
    few, many = (joined([solve_chunk(each) for each in chunks(one, n, 5)]).parameters for n in (600, 900))
    whole = 600 - 600 % CHUNK
    assert many.shape == (900, one.layout.size)
    assert np.array_equal(few[:whole], many[:whole])


def test_chunks_are_independent_of_solver_and_order() -> None:
    one = identified(noisy_points(sigma_mm=None), "conventional", BUDGET)
    work = chunks(one, 3 * CHUNK, 7)
    here = [solve_chunk(each).parameters for each in work]
    elsewhere = [solve_chunk(pickle.loads(pickle.dumps(each))).parameters for each in reversed(work)]
    assert all(np.array_equal(a, b) for a, b in zip(here, reversed(elsewhere), strict=True))


def test_only_the_covariance_changes() -> None:
    one = identified(model="conventional")
    found = drawn(one, 300, 7)
    assert np.array_equal(found.parameters, one.parameters)
    assert found.fit == one.fit
    assert found.covariance == pytest.approx(found.covariance.T)


def test_a_distribution_without_standard_deviation_is_refused() -> None:
    budget = Budget((Contributor("two readings", "length", 0.01, dof=1.0),))
    with pytest.raises(CalibrationError, match=r"two readings: .*take more readings"):
        chunks(identified(noisy_points(sigma_mm=None), budget=budget), 100, 1)


def test_an_exact_fit_is_refused() -> None:
    one = identified(noisy_points(sigma_mm=None), "conventional")
    exact = replace(one, fit=replace(one.fit, row_variance_mm2=0.0))
    with pytest.raises(CalibrationError, match=r"nothing is uncertain.*sigma_mm"):
        chunks(exact, 100, 1)
