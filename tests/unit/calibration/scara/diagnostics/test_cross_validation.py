"""Predictions of what was left out, against fits that really leave it out."""

from functools import cache

import numpy as np
import pytest
from scipy import optimize

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.folds import cross_validation, predicted_residuals
from catseye.calibration.scara.diagnostics.projection import DistanceProjection, projection_of
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem, split
from tests.unit.calibration.scara.paper import Truth, paper_points, random_truth, sequence, true_position

TRUTH = random_truth(9)


@cache
def noisy() -> Points:
    return measured(TRUTH, commands_on_nodes(), noise_mm=0.012, sigma_mm=0.012)


@cache
def fitted() -> DistanceProjection:
    return projection_of(problem(noisy()).solve())


def arm_of(points: Points) -> Truth:
    """Return what the program identifies as tables, to predict with the plain geometry of the tests."""
    found = problem(points)
    chosen = [found.points.reflector_names.index(name) for name in points.reflector_names]
    values = found.of_rows(np.isin(points.reflector, chosen)).solve().parameters
    one, two = values[2:24].tolist(), values[24:40].tolist()
    return Truth(
        float(values[0]),
        float(values[1]),
        {1: one[:11], -1: one[11:]},
        {1: two[:8], -1: two[8:]},
        np.zeros((3, 2)),
    )


def test_a_left_out_reflector_is_predicted_by_fitting_its_place() -> None:
    points = noisy()
    arm = arm_of(points.select(points.reflector != 2))
    at = np.array([true_position(arm, row) for row in sequence()])
    own = points.displacement_mm[points.reflector == 2]

    def misses(place: Floats) -> Floats:
        return np.asarray(np.hypot(*(at - place[:2]).T) - place[2] - own, dtype=np.float64)

    best = optimize.least_squares(misses, [640.0, 380.0, 500.0], x_scale=[1.0, 1.0, 1.0], xtol=1e-15)
    found = predicted_residuals(fitted(), "reflector")[points.reflector == 2]
    assert found == pytest.approx(misses(best.x), abs=2e-6)
    fold = cross_validation(fitted(), "reflector").folds[2]
    assert fold.name == "reflector P3"
    assert fold.predicted_um == pytest.approx(1e3 * float(np.sqrt(np.mean(misses(best.x) ** 2))), rel=1e-4)


def test_a_left_out_sweep_is_predicted_as_by_refitting() -> None:
    points, commands = noisy(), noisy().commands
    sweep = (np.abs(commands.theta1_rad) < 1e-9) & (commands.direction1 > 0) & (commands.direction2 < 0)
    without = problem(points.select(~sweep)).solve()
    refitted = distance_model(without.layout, points).residuals(without.parameters)[sweep]
    assert predicted_residuals(fitted(), "sweep")[sweep] == pytest.approx(refitted, abs=2e-6)


def test_left_out_segment_gets_a_dead_path_of_its_own() -> None:
    points = split(noisy(), 200)
    second = points.dead_path == 3
    without = problem(points.select(~second)).solve()
    alone = noisy().select(second)
    model = distance_model(without.layout, alone)
    raw = model.residuals(without.parameters)
    found = predicted_residuals(projection_of(problem(points).solve()), "segment")[second]
    assert found == pytest.approx(raw - raw.mean(), abs=2e-6)


def test_complete_model_predicts_as_well_as_expected() -> None:
    for way in ("reflector", "sweep"):
        found = cross_validation(fitted(), way)
        assert not any(fold.fails for fold in found.folds)
        assert found.predicted_um > found.in_sample_um
        assert found.predicted_um == pytest.approx(found.expected_um, rel=0.08)
    assert len(cross_validation(fitted(), "sweep").folds) == 44


def test_a_reflector_moved_during_measurement_fails_cross_validation() -> None:
    points = noisy()
    late = (points.reflector == 1) & (np.arange(1056) % 352 > 176)
    moved = Points(
        **{**points.__dict__, "displacement_mm": points.displacement_mm + np.where(late, 0.06, 0.0)}
    )
    folds = cross_validation(projection_of(problem(moved).solve()), "reflector").folds
    assert folds[1].fails
    assert folds[1].predicted_um > 1.5 * folds[1].expected_um


def test_the_only_reflector_or_sweep_has_no_prediction() -> None:
    points = paper_points(TRUTH, reflectors=1, noise_mm=np.random.default_rng(1).normal(0.0, 0.01, 352))
    alone = cross_validation(projection_of(problem(points).of_rows(np.arange(352)).solve()), "reflector")
    assert [fold.identified for fold in alone.folds] == [False]
    assert np.isnan(alone.predicted_um)
    commands = points.commands
    gone = (commands.theta1_rad < -2.4) & (commands.direction1 > 0) & (commands.direction2 > 0)
    fewer = problem(points).of_rows(~gone).solve()
    folds = cross_validation(projection_of(fewer), "sweep").folds
    assert [fold.name for fold in folds if not fold.identified] == ["θ1 = -140° (+), J2 −"]


@pytest.mark.parametrize("seed", range(3))
def test_probabilities_are_spread_when_nothing_is_wrong(seed: int) -> None:
    points = measured(TRUTH, commands_on_nodes(), noise_mm=0.012, sigma_mm=0.012, seed=50 + seed)
    folds = cross_validation(projection_of(problem(points).solve()), "sweep").folds
    assert min(fold.probability for fold in folds) > 0.01
