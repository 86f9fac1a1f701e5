"""Set points along a way: rest to rest, within bounds, through every target."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa.mxt.profile import Bounds, WayProfile
from catseye.drivers.roles.pose import Pose

CYCLE_S = 0.0071
BOUNDS = Bounds((20.0, 20.0, 50.0, 20.0), (200.0, 200.0, 500.0, 200.0))

angle = st.floats(-100.0, 100.0)
joints = st.tuples(angle, angle, st.floats(0.0, 150.0), angle)


def rates(start: Pose, points: list[Pose]) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest speed and acceleration of each joint, the standstills before and behind included."""
    positions = np.array([start, start, *points, points[-1], points[-1]])
    speed = np.diff(positions, axis=0) / CYCLE_S
    return np.abs(speed).max(axis=0), np.abs(np.diff(speed, axis=0) / CYCLE_S).max(axis=0)


@given(joints, joints)
def test_a_straight_path_respects_bounds_and_reaches_its_target(start: Pose, target: Pose) -> None:
    points = WayProfile(start, [target], BOUNDS).set_points(CYCLE_S)
    if max(abs(b - a) for a, b in zip(start, target, strict=True)) < 1e-9:
        assert points == []
        return
    assert points[-1] == pytest.approx(target, abs=1e-9)
    speed, acceleration = rates(start, points)
    assert np.all(speed <= np.array(BOUNDS.speed) * (1 + 1e-9) + 1e-9)
    # A very short way ends within a cycle; nothing samples an acceleration there.
    if len(points) > 10:
        assert np.all(acceleration <= np.array(BOUNDS.acceleration) * 1.02 + 1e-6)


def test_a_long_way_runs_at_the_fastest_joints_bound() -> None:
    points = WayProfile((0.0, 0.0, 0.0, 0.0), [(40.0, 10.0, 0.0, -20.0)], BOUNDS).set_points(CYCLE_S)
    speed, _ = rates((0.0, 0.0, 0.0, 0.0), points)
    assert speed[0] == pytest.approx(20.0, rel=1e-6)
    # 40 deg at 20 deg/s and one ramp of pi/2 * 20/200 s.
    assert len(points) * CYCLE_S == pytest.approx(2.0 + math.pi / 20.0, abs=CYCLE_S)


def test_targets_on_the_way_are_passed() -> None:
    way = [(float(n), 0.0, 0.0, 0.02 * n * n) for n in range(1, 21)]
    points = np.array(WayProfile((0.0, 0.0, 0.0, 0.0), way, BOUNDS).set_points(CYCLE_S))
    expected = np.interp(points[:, 0], np.arange(21.0), 0.02 * np.arange(21.0) ** 2)
    assert points[:, 3] == pytest.approx(expected, abs=1e-9)
    assert np.all(np.diff(points[:, 0]) >= -1e-12)


def test_repeated_targets_cost_no_time() -> None:
    once = WayProfile((0.0, 0.0, 0.0, 0.0), [(5.0, 0.0, 0.0, 0.0)], BOUNDS)
    twice = WayProfile((0.0, 0.0, 0.0, 0.0), [(0.0, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 0.0)], BOUNDS)
    assert twice.duration_s == once.duration_s
