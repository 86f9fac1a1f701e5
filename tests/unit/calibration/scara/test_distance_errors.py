"""How the contributors' errors are drawn: size, distribution, what they share, cosine errors, degrees of freedom."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.uncertainty import distance_errors
from tests.unit.calibration.scara.samples import identified, noisy_points

DRAWS = 4000
WHITE = Contributor("repeatability", "length", 0.010)


def with_budget(*contributors: Contributor) -> Identification:
    return identified(noisy_points(sigma_mm=None), budget=Budget(contributors))


def drawn(one: Identification, draws: int = DRAWS) -> Floats:
    """Return draws without what the fit widens them by."""
    errors = replace(distance_errors(one), factor=1.0, factor_dof=math.inf)
    return errors.draw(np.random.default_rng(1), draws)


def lengths_mm(one: Identification) -> Floats:
    """Return the beams' lengths from the identified dead paths."""
    dead = one.parameters[one.layout.dead_path][one.points.dead_path]
    return one.points.displacement_mm + one.residuals_mm + dead


def test_white_normal_errors_have_the_stated_size_and_share_nothing() -> None:
    errors = drawn(with_budget(WHITE, Contributor("second", "position", 0.005)))
    assert errors.shape == (DRAWS, 1056)
    assert float(errors.std()) == pytest.approx(math.hypot(0.010, 0.005), rel=0.005)
    correlation = np.corrcoef(errors[:, ::50], rowvar=False)
    assert np.abs(correlation - np.eye(22)).max() < 6.0 / math.sqrt(DRAWS)


def test_a_common_uniform_error_is_shared_and_bounded() -> None:
    common = Contributor("offset", "length", 0.010, "common", distribution="uniform")
    one = with_budget(Contributor("white", "length", 1e-6), common)
    errors = drawn(one)
    assert float(np.ptp(errors, axis=1).max()) < 1e-4
    assert float(errors[:, 0].std()) == pytest.approx(0.010, rel=0.02)
    assert 0.0170 < float(np.abs(errors).max()) < 0.010 * math.sqrt(3.0) + 1e-5


@pytest.mark.parametrize(
    ("shape", "kurtosis"), [("normal", 3.0), ("uniform", 1.8), ("triangular", 2.4), ("arcsine", 1.5)]
)
def test_white_errors_follow_their_distribution(shape: str, kurtosis: float) -> None:
    one = with_budget(Contributor("white", "length", 0.010, distribution=shape))  # type: ignore[arg-type]  # a plain string
    # A million errors: their standard deviation scatters by 0.07 % at most, their kurtosis by 0.2 %.
    square = drawn(one, 1000) ** 2
    assert float(np.sqrt(np.mean(square))) == pytest.approx(0.010, rel=0.005)
    assert float(np.mean(square * square) / np.mean(square) ** 2) == pytest.approx(kurtosis, rel=0.01)


def test_the_direction_of_the_beam_makes_cosine_errors() -> None:
    tilt = 5e-3
    one = with_budget(Contributor("beam", "direction", tilt))
    errors, length = drawn(one), lengths_mm(one)
    # L(1 − cos δ) of a normal δ: never negative, mean L u²/2, standard deviation L u²/√2.
    assert float(errors.min()) >= 0.0
    ratio = errors / length
    assert float(ratio.mean()) == pytest.approx(tilt**2 / 2.0, rel=0.005)
    assert float(ratio.std()) == pytest.approx(tilt**2 / math.sqrt(2.0), rel=0.01)
    # Half of the draws of a squared normal lie below 0.455.
    assert float(np.median(ratio)) == pytest.approx(0.4549 * tilt**2 / 2.0, rel=0.01)


def test_radial_motions_are_shared_by_distances_at_one_angle() -> None:
    radial = Contributor("radial J1", "radial", 0.010, "axis-angle", "j1", orders=3, spectrum=(1.0,) * 3)
    one = with_budget(Contributor("white", "length", 1e-6), radial)
    errors = drawn(one)
    commands = one.points.commands
    same = np.flatnonzero((commands.theta1_rad == commands.theta1_rad[0]) & (one.points.reflector == 0))
    assert float(errors.std()) == pytest.approx(0.010, rel=0.05)
    # Distances of one reflector from nearly one direction move together.
    assert float(np.corrcoef(errors[:, same[0]], errors[:, same[1]])[0, 1]) > 0.95


def test_few_degrees_of_freedom_widen_the_draws_in_common() -> None:
    errors = drawn(with_budget(Contributor("white", "length", 0.010, dof=6.0)))
    assert float(errors.std()) == pytest.approx(0.010 * math.sqrt(6.0 / 4.0), rel=0.03)
    # Each draw has a standard deviation of its own, with the spread of an estimate from 7 readings.
    own = errors.std(axis=1)
    assert float(np.mean((0.010 / own) ** 2)) == pytest.approx(1.0, rel=0.03)
    assert float(np.var((0.010 / own) ** 2)) == pytest.approx(2.0 / 6.0, rel=0.1)


def test_what_the_points_state_takes_the_place_of_white_contributors() -> None:
    radial = Contributor("radial J1", "radial", 0.010, "axis-angle", "j1")
    one = identified(noisy_points(sigma_mm=0.02), budget=Budget((WHITE, radial)))
    errors = distance_errors(one)
    assert [each.name for each in errors.contributors] == ["sigma_mm of the points", "radial J1"]
    assert errors.white[0].sigma_mm == pytest.approx(np.full(1056, 0.02))


def test_without_any_statement_the_scatter_of_the_fit_is_drawn() -> None:
    one = identified(noisy_points(sigma_mm=None))
    errors = distance_errors(one)
    assert [each.name for each in errors.contributors] == ["scatter of the fit"]
    assert errors.factor_dof == one.fit.dof
    everything = errors.draw(np.random.default_rng(2), DRAWS)
    assert float(everything.std()) == pytest.approx(1e-3 * one.fit.sigma0_um, rel=0.005)


def test_weights_and_white_contributors_agree() -> None:
    errors = distance_errors(with_budget(WHITE, Contributor("beam", "direction", 5e-3)))
    combined = np.sqrt(np.sum([each.sigma_mm**2 for each in errors.white], axis=0))
    one = with_budget(WHITE, Contributor("beam", "direction", 5e-3))
    assert one.points.sigma_mm is not None
    assert combined == pytest.approx(one.points.sigma_mm, rel=1e-12)
