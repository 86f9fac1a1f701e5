"""Studentised residuals against fits that really leave a distance out."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from catseye.calibration.core.residuals import studentised
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem
from tests.unit.calibration.scara.paper import random_truth

ROWS = [0, 17, 400, 700, 1055]


@cache
def noisy() -> Points:
    points = measured(random_truth(1), commands_on_nodes(), noise_mm=0.012)
    sigma = np.random.default_rng(2).uniform(0.008, 0.02, len(points))
    return replace(points, sigma_mm=sigma)


@cache
def fitted() -> Identification:
    return problem(noisy()).solve()


@pytest.mark.parametrize("row", ROWS)
def test_external_residual_leverage_and_cook_match_refitting(row: int) -> None:
    points, whole = noisy(), fitted()
    without = problem(points.select(np.arange(len(points)) != row)).solve()
    model = distance_model(whole.layout, points)
    assert points.sigma_mm is not None
    deleted = model.residuals(without.parameters)[row] / points.sigma_mm[row]
    basis = whole.layout.gauge_basis()
    jacobian = (model.jacobian(whole.parameters) / points.sigma_mm[:, None]) @ basis
    others = np.delete(jacobian, row, axis=0)
    spread = jacobian[row] @ np.linalg.solve(others.T @ others, jacobian[row])
    weighted = without.residuals_mm / np.delete(points.sigma_mm, row)
    s = float(np.sqrt(weighted @ weighted / without.fit.dof))
    found = studentised(projection_of(whole), stated=True)
    assert found.external[row] == pytest.approx(deleted / (s * np.sqrt(1.0 + spread)), rel=2e-4)
    assert found.leverage[row] == pytest.approx(spread / (1.0 + spread), rel=1e-6)
    assert whole.fit.chi2_reduced is not None
    step = jacobian @ (basis.T @ (without.parameters - whole.parameters))
    cook = float(step @ step) / (whole.fit.n_parameters * whole.fit.chi2_reduced)
    assert found.cook[row] == pytest.approx(cook, rel=1e-3)


def test_leverages_add_up_to_the_free_parameters() -> None:
    found = studentised(projection_of(fitted()), stated=True)
    assert float(found.leverage.sum()) == pytest.approx(fitted().fit.n_parameters, abs=1e-9)
    assert float(np.mean(found.internal**2)) == pytest.approx(1.0, rel=0.02)


def shared_by_poses(seed: int) -> Problem:
    rng = np.random.default_rng(seed)
    points = measured(random_truth(3), commands_on_nodes(), noise_mm=0.006, sigma_mm=0.006, seed=seed)
    angles = np.rad2deg(np.column_stack([points.commands.theta1_rad, points.commands.theta2_rad])).round()
    common = {pose: rng.normal(0.0, 0.015) for pose in sorted({(a, b) for a, b in angles.tolist()})}
    shared = np.array([common[(a, b)] for a, b in angles.tolist()])
    budget = Budget((Contributor("seat", "length", 0.015, "pose"),))
    return replace(problem(replace(points, displacement_mm=points.displacement_mm + shared)), budget=budget)


def test_normalised_residuals_account_for_errors_shared_by_poses() -> None:
    squares = []
    for seed in range(8):
        identified = shared_by_poses(seed).solve()
        found = studentised(projection_of(identified), stated=True)
        assert found.normalised is not None
        assert identified.fit.rms_um > 10.0
        squares.append(float(np.mean(found.normalised**2)))
    # About 130 of the 176 poses' errors are left in each draw: 0.12 of one draw, 0.04 of the mean of eight.
    assert float(np.mean(squares)) == pytest.approx(1.0, abs=0.13)


def test_a_distance_that_alone_determines_a_parameter_is_not_judged() -> None:
    points = noisy()
    kept = np.ones(len(points), dtype=np.bool_)
    commands = points.commands
    node = (commands.theta1_rad < -2.4) & (commands.direction1 < 0)
    kept[np.flatnonzero(node)[1:]] = False
    identified = problem(points.select(kept)).solve()
    found = studentised(projection_of(identified), stated=True)
    alone = np.flatnonzero(np.isnan(found.external))
    assert alone.size == 1
    assert found.leverage[alone[0]] == pytest.approx(1.0, abs=1e-9)
