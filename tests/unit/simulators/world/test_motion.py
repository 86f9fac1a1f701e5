"""Trapezoidal motion against hand calculation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.config import ArmDynamics, Joints
from catseye.simulators.world.motion import plan_motion, plan_stop

DYNAMICS = ArmDynamics(max_speed=(100.0, 200.0, 50.0, 400.0), max_acceleration=(500.0, 1000.0, 100.0, 2000.0))
HOME: Joints = (0.0, 0.0, 0.0, 0.0)

angles = st.floats(-170.0, 170.0)
poses = st.tuples(angles, angles, st.floats(0.0, 150.0), angles)


def test_a_long_motion_ramps_cruises_and_ramps() -> None:
    motion = plan_motion(HOME, (50.0, 0.0, 0.0, 0.0), 3.0, DYNAMICS)
    # 100 deg/s after 0.2 s and 10 deg; 30 deg at full speed take 0.3 s.
    assert motion.end_s == pytest.approx(3.7)
    places = [motion.joints_at(3.0 + t)[0] for t in (0.1, 0.2, 0.35, 0.5, 0.6, 0.7)]
    assert places == pytest.approx([2.5, 10.0, 25.0, 40.0, 47.5, 50.0])


def test_a_short_motion_never_reaches_full_speed() -> None:
    motion = plan_motion(HOME, (5.0, 0.0, 0.0, 0.0), 0.0, DYNAMICS)
    # 2.5 deg at 500 deg/s² take 0.1 s, and the same to brake.
    assert motion.end_s == pytest.approx(0.2)
    assert motion.joints_at(0.1)[0] == pytest.approx(2.5)


def test_all_joints_end_with_the_slowest() -> None:
    motion = plan_motion(HOME, (50.0, 50.0, 50.0, 50.0), 0.0, DYNAMICS)
    halfway = motion.joints_at(motion.end_s / 2.0)
    # J3 needs longest: 50 mm at 50 mm/s and 100 mm/s² take 1.5 s.
    assert motion.end_s == pytest.approx(1.5)
    assert halfway == pytest.approx((25.0, 25.0, 25.0, 25.0))


def test_the_override_lowers_the_speed_and_not_the_acceleration() -> None:
    motion = plan_motion(HOME, (50.0, 0.0, 0.0, 0.0), 0.0, DYNAMICS, speed_fraction=0.1)
    # 10 deg/s after 0.02 s and 0.1 deg.
    assert motion.end_s == pytest.approx(0.02 + 49.8 / 10.0 + 0.02)


def test_no_way_takes_no_time() -> None:
    motion = plan_motion(HOME, HOME, 2.0, DYNAMICS)
    assert motion.end_s == 2.0


def test_a_stop_brakes_on_the_same_path() -> None:
    motion = plan_motion(HOME, (50.0, 25.0, 0.0, 0.0), 0.0, DYNAMICS)
    stop = plan_stop(motion, 0.35, DYNAMICS)
    # From 100 deg/s at 500 deg/s²: 0.2 s and 10 deg.
    assert stop.end_s == pytest.approx(0.55)
    assert stop.end == pytest.approx((35.0, 17.5, 0.0, 0.0))
    assert stop.joints_at(0.45)[0] == pytest.approx(25.0 + 10.0 - 2.5)


def test_a_stop_while_braking_changes_nothing() -> None:
    motion = plan_motion(HOME, (50.0, 0.0, 0.0, 0.0), 0.0, DYNAMICS)
    stop = plan_stop(motion, 0.6, DYNAMICS)
    assert stop.end == pytest.approx(motion.end)
    assert stop.end_s == pytest.approx(motion.end_s)


@given(start=poses, end=poses, override=st.floats(0.01, 1.0), when=st.floats(0.0, 1.0))
def test_a_motion_is_monotone_and_within_the_limits(
    start: Joints, end: Joints, override: float, when: float
) -> None:
    motion = plan_motion(start, end, 0.0, DYNAMICS, override)
    times = np.linspace(0.0, motion.end_s, 101)
    done = motion.profile.fraction(times) if motion.end_s else np.ones(101)
    assert np.all(np.diff(done) >= -1e-12)
    assert done[-1] == pytest.approx(1.0)
    for joint, limit in enumerate(DYNAMICS.max_speed):
        assert motion.profile.speed * abs(end[joint] - start[joint]) <= limit * override * (1.0 + 1e-9)
    stop = plan_stop(motion, when * motion.end_s, DYNAMICS)
    assert stop.end_s <= motion.end_s + 1e-9
