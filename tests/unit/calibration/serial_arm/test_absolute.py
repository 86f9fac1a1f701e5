"""The base in absolute values against numerical derivatives and the arm's own place."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.serial_arm.absolute import absolute, base_place
from catseye.calibration.serial_arm.identification import Calibration, identify_arm
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import BASE, random_poses


@pytest.fixture(scope="module")
def found() -> Calibration:
    rows = measured(random_poses(38, 1), 1)
    motion = pose_of(np.array([100.0, 50.0, -20.0]), np.array([20.0, -35.0, 70.0]))
    places = rows.points.place_mm @ motion[:3, :3].T + motion[:3, 3]
    return identify_arm(
        irb120(), replace(rows, points=replace(rows.points, place_mm=places)), "geometric+compliance"
    )


def test_base_is_that_of_the_true_arm() -> None:
    exact = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    known = absolute(exact)
    assert known.names[:6] == (
        "base.x_mm",
        "base.y_mm",
        "base.z_mm",
        "base.rx_deg",
        "base.ry_deg",
        "base.rz_deg",
    )
    assert known.values[:6] == pytest.approx(BASE, abs=1e-7)


def test_covariance_of_the_base_follows_its_steps(found: Calibration) -> None:
    slopes, step = np.zeros((6, 6)), 1e-4
    for k in range(6):
        moved = np.eye(len(found.estimate.values))[k] * step
        up = base_place(found.model.geometry(found.estimate.values + moved))
        down = base_place(found.model.geometry(found.estimate.values - moved))
        slopes[:, k] = (up - down) / (2.0 * step)
    wanted = slopes @ found.estimate.covariance[:6, :6] @ slopes.T
    assert absolute(found).covariance[:6, :6] == pytest.approx(wanted, rel=1e-5, abs=1e-12)


def test_links_keep_their_values(found: Calibration) -> None:
    assert absolute(found).values[6:] == pytest.approx(found.estimate.values[6:])
    assert np.diag(absolute(found).correlation) == pytest.approx(1.0)
