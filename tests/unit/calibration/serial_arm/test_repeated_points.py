"""Points measured again, each with a covariance of its own, against the weighted means of their places."""

import numpy as np
import pytest

from catseye.calibration.core.lack_of_fit import LackOfFit
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import ModelName, identify_arm
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from tests.unit.calibration.serial_arm.nominal import NOISE_MM, irb120
from tests.unit.calibration.serial_arm.true_arm import NESTS, TrueArm, random_poses

POSES = 40
TIMES = 3


def measured_again(seed: int) -> Measurements:
    """Measure a nest a pose three times, with errors of 10, 40 and 120 µm or so along axes that differ every time."""
    rng, rows = np.random.default_rng(seed), POSES * TIMES
    pose = np.repeat(np.arange(POSES), TIMES)
    nest, poses = pose % len(NESTS), random_poses(POSES, seed)
    axes = np.linalg.qr(rng.standard_normal((rows, 3, 3)))[0]
    u_mm = np.array([0.01, 0.04, 0.12]) * rng.uniform(0.7, 1.4, (rows, 3))
    off = np.einsum("nij,nj->ni", axes, u_mm * rng.standard_normal((rows, 3)))
    covariance = np.einsum("nij,nj,nkj->nik", axes, u_mm**2, axes)
    points = MeasuredPoints(pose, nest, TrueArm().nests(poses[pose], nest) + off, covariance)
    return Measurements(Commands.of(irb120(), poses), tuple(map(str, range(POSES))), points)


def scatter(points: MeasuredPoints) -> float:
    """Return the mean square of places about the weighted means of their repeats, in units of what is stated."""
    assert points.covariance_mm2 is not None
    square = 0.0
    for pose in range(POSES):
        again = points.pose == pose
        inverse, places = np.linalg.inv(points.covariance_mm2[again]), points.place_mm[again]
        mean = np.linalg.solve(inverse.sum(axis=0), np.einsum("nij,nj->i", inverse, places))
        square += float(np.einsum("ni,nij,nj->", places - mean, inverse, places - mean))
    return square / (3 * POSES * (TIMES - 1))


def unit_um(covariance_mm2: Floats) -> float:
    """Return the standard uncertainty, µm, whose square has the mean reciprocal of the variances'."""
    return 1e3 / float(np.sqrt(np.mean(1.0 / np.linalg.eigvalsh(covariance_mm2))))


def test_what_comes_from_other_sides_repeats_nothing() -> None:
    """Backlash is no scatter of an arm that comes again in the same way."""
    count, play_deg = 20, np.array([0.0, 0.05, 0.0, 0.0, 0.0, 0.0])
    poses = np.repeat(random_poses(count, 5), 4, axis=0)
    sides = np.tile([[1.0], [1.0], [-1.0], [-1.0]], (count, 6))
    nest = np.arange(count).repeat(4) % len(NESTS)
    places = TrueArm().nests(poses + 0.5 * sides * play_deg, nest)
    places += NOISE_MM * np.random.default_rng(5).standard_normal(places.shape)
    points = MeasuredPoints(
        np.arange(4 * count), nest, places, np.tile(NOISE_MM**2 * np.eye(3), (4 * count, 1, 1))
    )
    arm = irb120()
    rows = Measurements(Commands.of(arm, poses, sides), tuple(map(str, range(4 * count))), points)
    found = lack(rows, "geometric+compliance")
    assert found.pure_um == pytest.approx(1e3 * NOISE_MM, rel=0.2)
    assert found.significant


def lack(rows: Measurements, name: ModelName) -> LackOfFit:
    found = identify_arm(irb120(), rows, name).estimate.fit.lack_of_fit
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["geometric", "geometric+compliance"])
def test_pure_scatter_is_that_about_weighted_means(name: ModelName) -> None:
    rows = measured_again(1)
    assert rows.points.covariance_mm2 is not None
    expected = unit_um(rows.points.covariance_mm2) * np.sqrt(scatter(rows.points))
    assert lack(rows, name).pure_um == pytest.approx(expected, rel=1e-6)


def test_repeats_tell_what_the_model_lacks() -> None:
    rows = measured_again(1)
    assert lack(rows, "geometric").significant
    assert not lack(rows, "geometric+compliance").significant


def test_complete_model_lacks_fit_as_rarely_as_stated() -> None:
    found = [lack(measured_again(seed), "geometric+compliance").probability for seed in range(10, 20)]
    assert min(found) > 1e-4
    assert 0.2 < float(np.mean(found)) < 0.8
