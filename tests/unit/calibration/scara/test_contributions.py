"""The covariance taken apart: sums, closed forms, and identifications with one contributor at a time."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from catseye.calibration.scara.uncertainty import contributions
from tests.unit.calibration.scara.samples import identified, noisy_points

CONTRIBUTORS = (
    Contributor("repeatability", "length", 0.010),
    Contributor("beam", "direction", 5e-3),
    Contributor("wavelength", "scale", 3e-6, "common"),
    Contributor("arrival", "position", 0.004, "pose"),
    Contributor("encoder", "angle", 2e-5, "axis-angle", "j2"),
    Contributor("radial motion", "radial", 0.005, "axis-angle", "j4"),
)


def path() -> Commands:
    rng = np.random.default_rng(1)
    theta1, theta2 = np.deg2rad(rng.uniform(-140, 60, 50)), np.deg2rad(rng.uniform(0, 140, 50))
    return Commands(theta1, theta2, rng.choice([-1, 1], 50), rng.choice([-1, 1], 50))


def test_parts_sum_to_the_covariance() -> None:
    one = identified(noisy_points(sigma_mm=None), budget=Budget(CONTRIBUTORS))
    found = contributions(one)
    assert found.names == tuple(each.name for each in CONTRIBUTORS)
    scale = np.outer(one.standard_uncertainty, one.standard_uncertainty)
    assert np.abs((found.covariance - one.covariance) / scale).max() < 1e-9
    assert found.variances.sum(axis=0) == pytest.approx(np.diag(one.covariance), rel=1e-9)


@pytest.mark.parametrize("model", ["error-map", "conventional"])
def test_parts_sum_to_a_covariance_that_was_widened(model: str) -> None:
    one = identified(noisy_points(sigma_mm=0.005), model)  # type: ignore[arg-type]  # a plain string
    assert one.fit.variance_ratio > 1.5
    assert contributions(one).covariance == pytest.approx(one.covariance, rel=1e-6, abs=1e-18)


@pytest.mark.parametrize("contributor", CONTRIBUTORS[2:], ids=lambda one: one.name)
def test_a_part_is_what_the_contributors_errors_do_to_estimates(contributor: Contributor) -> None:
    """The estimate is moved by each source in turn; the budget's weights stay as they are."""
    points = noisy_points(sigma_mm=0.0156)
    one = identified(points, budget=Budget((contributor,)))
    assert one.budget is not None
    part = contributions(one).covariances[1] / one.fit.variance_ratio
    moved = np.zeros_like(part)
    for effect in one.model.shared(one.parameters)[0].effects_mm.T:
        shift = estimates_beside(one, 0.1 * effect) / 0.2
        moved += np.outer(shift, shift)
    u = one.standard_uncertainty
    assert np.abs((part - moved) / np.outer(u, u)).max() < 1e-4


def estimates_beside(one: Identification, effect_mm: Floats) -> Floats:
    """Return the difference of the estimates with an error added to the distances and taken off."""
    first, second = (
        identified(
            replace(one.points, displacement_mm=one.points.displacement_mm + sign * effect_mm),
            budget=one.budget,
        ).parameters
        for sign in (1.0, -1.0)
    )
    return first - second


def test_a_common_scale_scales_the_arm_and_turns_nothing() -> None:
    one = identified(noisy_points(sigma_mm=None), budget=Budget(CONTRIBUTORS))
    u = np.sqrt(contributions(one).variances[2])
    assert u[:2] == pytest.approx(3e-6 * one.parameters[:2], rel=1e-3)
    assert u[one.layout.reflectors] == pytest.approx(
        3e-6 * np.abs(one.parameters[one.layout.reflectors]), rel=0.05
    )
    assert float(u[one.layout.map1].max()) < 1e-9


def numerical_gradient(arm_parameters: Floats, commands: Commands) -> Floats:
    """Return derivatives of x and y by the arm's parameters, from differences of plain trigonometry."""
    nodes1, nodes2 = np.deg2rad(np.arange(-140.0, 61.0, 20.0)), np.deg2rad(np.arange(0.0, 141.0, 20.0))

    def positions(p: Floats) -> Floats:
        rows = []
        for t1, t2, s1, s2 in zip(
            commands.theta1_rad, commands.theta2_rad, commands.direction1, commands.direction2, strict=True
        ):
            first, second = (2, 24) if s1 > 0 else (13, 24), (24, 32) if s2 > 0 else (32, 40)
            a = t1 + np.interp(t1, nodes1, p[first[0] : first[0] + 11])
            b = a + t2 + np.interp(t2, nodes2, p[second[0] : second[1]])
            rows.append([p[0] * math.cos(a) + p[1] * math.cos(b), p[0] * math.sin(a) + p[1] * math.sin(b)])
        return np.array(rows)

    columns = []
    for i in range(arm_parameters.size):
        step = np.zeros(arm_parameters.size)
        step[i] = 1e-5
        columns.append((positions(arm_parameters + step) - positions(arm_parameters - step)) / 2e-5)
    return np.stack(columns, axis=2)


def test_covariance_of_predicted_positions_is_that_of_a_numerical_gradient() -> None:
    arm = identified().arm
    gradient = numerical_gradient(arm.parameters, path())
    expected = np.einsum("nip,pq,njq->nij", gradient, arm.covariance, gradient)
    found = predict(arm, path(), 325.0, 225.0)
    assert found.covariance_mm2 == pytest.approx(expected, rel=1e-5, abs=1e-12)
    assert found.u_mm**2 == pytest.approx(np.einsum("nii->ni", expected), rel=1e-5)


def test_effective_degrees_of_freedom_by_hand() -> None:
    white = Contributor("few readings", "length", 0.0156, dof=5.0)
    scale = Contributor("wavelength", "scale", 3e-6, "common", dof=20.0)
    one = identified(noisy_points(sigma_mm=None), budget=Budget((white, scale)))
    assert one.fit.variance_ratio == 1.0
    found = contributions(one)
    first, second = found.variances[:, 0]
    expected = (first + second) ** 2 / (first**2 / 5.0 + second**2 / 20.0)
    assert found.effective_dof(found.variances)[0] == pytest.approx(expected)


def test_fit_scatter_has_the_fits_degrees_of_freedom() -> None:
    one = identified(noisy_points(sigma_mm=None))
    found = contributions(one)
    assert found.effective_dof(found.variances) == pytest.approx(np.full(one.layout.size, one.fit.dof))
