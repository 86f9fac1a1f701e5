"""Sizes of what rows share: a scatter of whole poses and a moving base, however wrongly uncertainties are stated."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.fitted import Fitted, with_shared
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import identify_arm
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from tests.unit.calibration.serial_arm.nominal import NOISE_MM, irb120
from tests.unit.calibration.serial_arm.true_arm import TrueArm, random_poses

POSES = 60
STATED = pytest.mark.parametrize("stated", [0.1, 1.0, 10.0])


def of_three_nests(moved_mm: Floats, seed: int, stated: float | None) -> Measurements:
    """Measure three nests a pose, which are moved by so much, (poses, 3), and state that many times the noise."""
    poses = random_poses(POSES, seed)
    pose, nest = np.repeat(np.arange(POSES), 3), np.tile(np.arange(3), POSES)
    places = TrueArm().nests(poses[pose], nest) + moved_mm[pose]
    places = places + NOISE_MM * np.random.default_rng(seed).standard_normal(places.shape)
    covariance = None
    if stated is not None:
        covariance = np.tile((stated * NOISE_MM) ** 2 * np.eye(3), (len(pose), 1, 1))
    names = tuple(f"pose {k + 1}" for k in range(POSES))
    return Measurements(Commands.of(irb120(), poses), names, MeasuredPoints(pose, nest, places, covariance))


def shared(rows: Measurements) -> Fitted:
    return with_shared(identify_arm(irb120(), rows, "geometric+compliance"))


@STATED
def test_scatter_of_poses_is_in_mm_whatever_is_stated(stated: float) -> None:
    moved = 0.1 * np.random.default_rng(31).standard_normal((POSES, 3))
    found = shared(of_three_nests(moved, 3, stated))
    assert found.drift_mm is None
    assert found.scatter_mm == pytest.approx(0.1, rel=0.25)


@pytest.mark.parametrize("stated", [0.1, 1.0, 10.0, None])
def test_steady_drift_is_the_motion_from_first_to_last(stated: float | None) -> None:
    moved = np.linspace(0.0, 1.0, POSES)[:, None] * np.array([0.2, -0.2, 0.2])
    assert shared(of_three_nests(moved, 4, stated)).drift_mm == pytest.approx(0.2, rel=0.2)


def test_base_that_came_back_went_as_far_as_its_turn() -> None:
    there_and_back = 1.0 - np.abs(np.linspace(-1.0, 1.0, POSES))
    moved = there_and_back[:, None] * np.array([0.3, 0.3, -0.3])
    assert shared(of_three_nests(moved, 5, 1.0)).drift_mm == pytest.approx(0.3, rel=0.2)


def test_drift_keeps_its_size_beside_a_scatter() -> None:
    moved = 0.1 * np.random.default_rng(32).standard_normal((POSES, 3))
    moved = moved + np.linspace(0.0, 1.0, POSES)[:, None] * np.array([0.4, -0.4, 0.4])
    found = shared(of_three_nests(moved, 6, 1.0))
    assert found.drift_mm == pytest.approx(0.4, rel=0.3)
    assert found.scatter_mm == pytest.approx(0.1, rel=0.3)


def test_exact_rows_with_stated_noise_share_nothing_large() -> None:
    rows = of_three_nests(np.zeros((POSES, 3)), 7, 1.0)
    exact = TrueArm().nests(random_poses(POSES, 7)[rows.points.pose], rows.points.target)
    found = shared(replace(rows, points=replace(rows.points, place_mm=exact)))
    assert found.drift_mm is None or found.drift_mm < 1e-6
    assert found.scatter_mm is None or found.scatter_mm < 1e-6
