"""Circles of turned targets against circles that are constructed by rotation vectors, and the axes in them."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.axis_frames import AxisLine, frame_of_axes, nominal_axis
from catseye.calibration.serial_arm.circles import axis_errors, circle_of
from tests.unit.procedures.six_axes import CHAIN

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
CENTRE = np.array([120.0, -40.0, 300.0])
ARM = np.cross(AXIS, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(AXIS, [0.0, 0.0, 1.0]))
RADIUS = 250.0


def turned(angle_deg: Floats, radius: Floats | float = RADIUS, axial: Floats | float = 0.0) -> Floats:
    """Return a target on a circle, by Rodrigues' formula of scipy."""
    arms = Rotation.from_rotvec(np.deg2rad(angle_deg)[:, None] * AXIS).apply(ARM)
    return np.asarray(CENTRE + np.reshape(radius, (-1, 1)) * arms + np.reshape(axial, (-1, 1)) * AXIS)


@pytest.mark.parametrize("reach", [15.0, 60.0, 155.0, 400.0])
def test_a_circle_is_found_whatever_its_arc(reach: float) -> None:
    q = np.arange(-reach, reach + 1.0, 5.0)
    found = circle_of(q, turned(q))
    assert found.centre_mm == pytest.approx(CENTRE, abs=1e-6)
    assert found.axis == pytest.approx(AXIS, abs=1e-9)
    assert found.radius_mm == pytest.approx(RADIUS, abs=1e-6)
    assert found.angle_deg - found.angle_deg[0] == pytest.approx(q - q[0], abs=1e-6)


def test_a_joint_of_the_other_sense_has_the_other_axis() -> None:
    q = np.arange(-60.0, 61.0, 5.0)
    assert circle_of(q, turned(-q)).axis == pytest.approx(-AXIS, abs=1e-9)


def test_tangential_error_is_the_missing_angle_times_the_radius() -> None:
    q = np.arange(-60.0, 61.0, 5.0)
    error_deg = 0.05 * np.sin(np.deg2rad(2.0 * q))
    found = axis_errors(q, turned(q + error_deg), np.ones(len(q), dtype=bool))
    assert found.angular_deg == pytest.approx(error_deg, abs=1e-6)
    assert found.angular_range_deg == pytest.approx(0.1, abs=1e-3)
    assert found.tangential_range_mm == pytest.approx(math.radians(np.ptp(error_deg)) * RADIUS, rel=1e-5)
    assert found.backlash_deg is None


def test_backlash_is_what_both_ways_differ_by() -> None:
    up = np.arange(-155.0, 156.0, 5.0)
    q = np.concatenate([up, up[::-1]])
    below = np.repeat([True, False], len(up))
    found = axis_errors(q, turned(q + np.where(below, 0.0185, -0.0185)), below)
    assert found.backlash_deg == pytest.approx(0.037, abs=1e-9)
    # At the reference both ways count together.
    assert found.angular_deg[below] == pytest.approx(np.full(len(up), 0.0185), abs=1e-6)


def test_radial_and_axial_errors_are_told_apart() -> None:
    q = np.arange(-180.0, 180.0, 5.0)
    wave = np.sin(np.deg2rad(3.0 * q))
    found = axis_errors(q, turned(q, RADIUS + 0.04 * wave, 0.03 * np.roll(wave, 6)), np.ones(len(q), bool))
    assert found.radial_mm == pytest.approx(0.04 * wave, abs=1e-4)
    assert np.ptp(found.axial_mm) == pytest.approx(0.06, abs=1e-4)
    assert found.tangential_range_mm < 1e-6


def test_noise_leaves_the_centre_within_its_uncertainty() -> None:
    q = np.arange(-60.0, 61.0, 5.0)
    offs = []
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0.0, 0.02, (len(q), 3))
        offs.append(circle_of(q, turned(q) + noise).centre_mm - CENTRE)
    across = np.array(offs) @ np.cross(AXIS, ARM)
    # The middle of the arc lies on ARM; across it all 25 places tell the centre, cos² in the mean.
    expected = 0.02 / math.sqrt(float(np.sum(np.sin(np.deg2rad(q)) ** 2)))
    assert float(across.std()) == pytest.approx(expected, rel=0.15)
    assert abs(float(across.mean())) < 4.0 * expected / math.sqrt(200)


@pytest.mark.parametrize("q", [np.arange(4.0), np.zeros(10)])
def test_too_few_places_show_no_circle(q: Floats) -> None:
    with pytest.raises(InsufficientPointsError, match="no circle"):
        circle_of(q, turned(q))


def test_places_on_a_line_are_refused() -> None:
    q = np.arange(10.0)
    with pytest.raises(InsufficientPointsError, match="line"):
        circle_of(q, np.outer(q, AXIS))


def moved(line: AxisLine, motion: Floats) -> AxisLine:
    point = motion[:3, :3] @ line.point_mm + motion[:3, 3]
    direction = motion[:3, :3] @ line.direction
    # Any point of the line is as good.
    return AxisLine(point + 77.0 * direction, direction)


@pytest.mark.parametrize("joints", [(1, 2), (6, 5), (3, 4)])
def test_two_axes_give_the_frame_back(joints: tuple[int, int]) -> None:
    motion = np.eye(4)
    motion[:3, :3] = Rotation.from_euler("xyz", [10.0, -20.0, 130.0], degrees=True).as_matrix()
    motion[:3, 3] = [-2300.0, 300.0, -350.0]
    pose = np.array([10.0, 20.0, -30.0, 40.0, 50.0, -60.0])
    one, other = (nominal_axis(CHAIN, joint, pose) for joint in joints)
    found = frame_of_axes((one, other), (moved(one, motion), moved(other, motion)))
    assert found == pytest.approx(motion, abs=1e-9)


def test_parallel_axes_give_no_frame() -> None:
    one, other = (nominal_axis(CHAIN, joint, np.zeros(6)) for joint in (2, 3))
    with pytest.raises(UnidentifiableError, match="parallel"):
        frame_of_axes((one, other), (one, other))
