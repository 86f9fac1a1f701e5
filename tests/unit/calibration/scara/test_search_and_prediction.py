"""Eq. 2, prediction and comparison against geometry done by hand."""

import math

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.scara.comparison import compare, rigid_fit
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from catseye.calibration.scara.reflector_search import Sightings, locate_reflectors
from tests.unit.calibration.scara.paper import (
    NOMINAL_REFLECTORS,
    paper_points,
    random_truth,
    sequence,
    true_position,
)
from tests.unit.calibration.scara.samples import identified

POSES = [(-100.0, 40.0), (-60.0, 80.0), (-20.0, 30.0), (0.0, 100.0), (30.0, 60.0), (50.0, 20.0)]


def sightings(places: np.ndarray, theta40: float, noise: np.ndarray) -> Sightings:
    rows = []
    for j, (x, y) in enumerate(places):
        for a_deg, b_deg in POSES:
            a, b = math.radians(a_deg), math.radians(b_deg)
            px = 325 * math.cos(a) + 225 * math.cos(a + b)
            py = 325 * math.sin(a) + 225 * math.sin(a + b)
            rows.append((a, b, math.atan2(y - py, x - px) - a - b - theta40, j))
    table = np.array(rows)
    return Sightings(table[:, 0], table[:, 1], table[:, 2] + noise, table[:, 3].astype(np.int64))


def test_search_finds_places_and_zero_direction() -> None:
    places = NOMINAL_REFLECTORS + np.array([[5.0, -8.0], [-6.0, 4.0], [9.0, 7.0]])
    found = locate_reflectors(sightings(places, 0.031, np.zeros(18)), 325.0, 225.0, NOMINAL_REFLECTORS)
    assert found.reflectors_mm == pytest.approx(places, abs=1e-6)
    assert found.theta40_rad == pytest.approx(0.031, abs=1e-9)


def test_search_uncertainty_is_honest() -> None:
    places = NOMINAL_REFLECTORS + 3.0
    normalised, aims, predicted = [], [], []
    pose = np.array([[200.0, -300.0]])
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0.0, 1e-4, 18)
        found = locate_reflectors(sightings(places, 0.02, noise), 325.0, 225.0, NOMINAL_REFLECTORS)
        normalised.append((found.reflectors_mm - places) / found.u_reflectors_mm)
        beam, true = found.reflectors_mm[1] - pose[0], places[1] - pose[0]
        angle = math.atan2(*beam[::-1]) - found.theta40_rad - (math.atan2(*true[::-1]) - 0.02)
        aims.append(angle * float(np.hypot(*true)))
        predicted.append(found.aim_uncertainty_mm(pose, 1)[0])
    # Student's t with 11 degrees of freedom has a standard deviation of 1.11.
    assert 1.0 < float(np.sqrt(np.mean(np.square(normalised)))) < 1.22
    assert float(np.std(aims)) == pytest.approx(float(np.mean(predicted)), rel=0.12)


def test_search_needs_sightings_of_each_reflector() -> None:
    full = sightings(NOMINAL_REFLECTORS, 0.0, np.zeros(18))
    few = Sightings(full.theta1_rad[:7], full.theta2_rad[:7], full.j4_rad[:7], full.reflector[:7])
    with pytest.raises(InsufficientPointsError, match="search at more poses"):
        locate_reflectors(few, 325.0, 225.0, NOMINAL_REFLECTORS)


def test_prediction_of_the_commands_gives_the_true_positions() -> None:
    truth = random_truth(5)
    found = identified(paper_points(truth, sigma_mm=0.0156))
    commands = found.points.commands.select(np.arange(352))
    predicted = predict(found.arm, commands, 325.0, 225.0)
    expected = np.array([true_position(truth, row) for row in sequence()])
    assert predicted.position_mm == pytest.approx(expected, abs=1e-9)
    assert predicted.inside.all()
    assert float(predicted.u_mm.min()) > 1e-3
    assert float(predicted.u_mm.max()) < 12e-3


def test_rows_outside_the_nodes_are_not_predicted() -> None:
    result = identified(paper_points(random_truth(6)))
    commands = Commands(
        np.deg2rad([0.0, 0.0]), np.deg2rad([139.0, 141.0]), np.array([1, 1]), np.array([1, 1])
    )
    predicted = predict(result.arm, commands, 325.0, 225.0)
    assert predicted.inside.tolist() == [True, False]
    assert np.isnan(predicted.position_mm[1]).all()
    assert np.isnan(predicted.u_mm[1]).all()


def test_rigid_fit_undoes_a_turn_and_a_shift() -> None:
    source = np.random.default_rng(1).normal(0.0, 300.0, (20, 2))
    turn = 0.3
    target = np.array(
        [
            [math.cos(turn) * x - math.sin(turn) * y + 12.0, math.sin(turn) * x + math.cos(turn) * y - 7.0]
            for x, y in source
        ]
    )
    fit = rigid_fit(source, target)
    assert fit.rotation_rad == pytest.approx(turn, abs=1e-12)
    assert fit.apply(source) == pytest.approx(target, abs=1e-9)


def test_comparison_ignores_the_frame_but_not_the_shape() -> None:
    command = np.random.default_rng(2).uniform(-400.0, 400.0, (50, 2))
    error = np.random.default_rng(3).normal(0.0, 0.02, (50, 2))
    turn = 0.01
    measured = np.array(
        [
            [math.cos(turn) * x - math.sin(turn) * y + 5.0, math.sin(turn) * x + math.cos(turn) * y]
            for x, y in command + error
        ]
    )
    inside = np.ones(50, dtype=np.bool_)
    against_command = compare(command, command, measured, inside)
    against_truth = compare(command, command + error, measured, inside)
    assert against_truth.rms_2d_um < 1e-6
    assert against_truth.transform.rotation_rad == pytest.approx(-turn, abs=1e-9)
    assert against_command.rms_2d_um == pytest.approx(
        1e3 * float(np.sqrt(np.mean(np.sum(error**2, axis=1)))), rel=0.05
    )
