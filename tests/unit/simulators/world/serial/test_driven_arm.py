"""The arm as a controller leads it: pure in its commands and their times, cheap to look at."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm
from tests.unit.simulators.world.serial.trials import STEPS_DEG

ARM = serial_arm("kr210-r2700", TOOL)
TRUTHS = draw_joint_truth(ARM, 3).joints
START = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)


def arm() -> DrivenArm:
    return DrivenArm(ARM, TRUTHS, START, seed=3)


def shifted(joint: int, by_deg: float) -> tuple[float, ...]:
    return tuple(value + by_deg * (k == joint) for k, value in enumerate(START))


def test_a_pose_is_reached_but_for_play_and_overtravel() -> None:
    driven = arm()
    driven.move_to((20.0, -70.0, 60.0, 30.0, 40.0, -50.0), 0.0, 1.0)
    reached = np.array(driven.true_joints(60.0))
    assert np.abs(reached - driven.motion.end).max() < 0.05
    assert np.abs(np.subtract(driven.measured(60.0), driven.motion.end)).max() < 1e-3


@given(looks_s=st.lists(st.floats(0.0, 11.0), max_size=8))
@settings(max_examples=25, deadline=None)
def test_links_do_not_depend_on_who_looks_when(looks_s: list[float]) -> None:
    left, watched = arm(), arm()
    times_s = np.linspace(0.0, 12.0, 37)
    looks = sorted(looks_s)
    for driven in (left, watched):
        for k, at_s in enumerate((0.0, 4.0, 8.0)):
            for look in looks if driven is watched else ():
                if look < at_s:
                    driven.true_joints(look)
                    driven.measured(look)
                    driven.torques_nm(look)
            driven.move_to(shifted(4, 0.1 * (k - 1)), at_s, 1e-3)
    np.testing.assert_array_equal(watched.links_deg(times_s), left.links_deg(times_s))


def test_many_times_are_looked_at_as_one_by_one() -> None:
    driven = arm()
    driven.move_to(shifted(0, 2.0), 0.0, 0.01)
    driven.move_to(shifted(0, 2.1), 5.0, 0.001)
    times_s = np.linspace(0.0, 8.0, 161)
    one_by_one = [driven.true_joints(float(t)) for t in times_s]
    np.testing.assert_allclose(driven.links_deg(times_s), one_by_one, rtol=0.0, atol=1e-12)


def test_links_never_jump() -> None:
    driven = arm()
    driven.move_to(shifted(4, 3.0), 0.0, 1e-2)
    driven.brake(1.0)
    driven.move_to(shifted(4, 1.0), 3.0, 1e-2)
    links = driven.links_deg(np.arange(0.0, 8.0, 1e-4))[:, 4]
    # 1.72 deg/s are 1.7e-4 deg in a sample; what ringing adds is of the same size.
    assert np.abs(np.diff(links)).max() < 4e-4


def test_a_brake_ends_a_motion_before_its_target() -> None:
    driven = arm()
    driven.move_to(shifted(0, 30.0), 0.0, 0.1)
    driven.brake(1.0)
    assert 0.0 < driven.true_joints(5.0)[0] < 13.0
    assert driven.motion.end_s < 1.5


def test_weight_of_another_joint_bends_a_resting_one() -> None:
    driven = arm()
    driven.move_to(shifted(2, -60.0), 0.0, 0.5)
    bent_deg = driven.true_joints(20.0)[1] - driven.true_joints(0.0)[1]
    assert 1e-3 < abs(bent_deg) < 0.05


def test_steps_of_one_joint_leave_another_one_creeping_only() -> None:
    driven = arm()
    driven.move_to(shifted(4, 1.0), 0.0, 0.1)
    for k in range(20):
        driven.move_to((0.1 * (k + 1), *shifted(4, 1.0)[1:]), 60.0 + 5.0 * k, 1e-3)
    assert driven.true_joints(160.0)[4] == pytest.approx(driven.true_joints(60.0)[4], abs=1e-6)


def test_torques_show_load_and_direction_of_friction() -> None:
    driven = arm()
    driven.move_to(shifted(2, 5.0), 0.0, 0.01)
    forth_nm = driven.torques_nm(20.0)[2]
    driven.move_to(START, 20.0, 0.01)
    back_nm = driven.torques_nm(40.0)[2]
    # Forth and back differ by twice the friction, a little of which has crept away; the weight is near in both.
    friction_nm = TRUTHS[2].link_friction_nm + TRUTHS[2].motor_friction_nm
    assert forth_nm - back_nm == pytest.approx(2.0 * friction_nm, rel=0.25)
    assert forth_nm < 0.0


def test_a_test_at_one_kilohertz_costs_seconds() -> None:
    started_s = time.process_time()
    driven, at_s = arm(), 0.0
    for size in STEPS_DEG:
        driven.move_to(shifted(0, driven.measured(at_s)[0] + float(size)), at_s, 1e-3)
        at_s += 8.0
    links = driven.links_deg(np.arange(0.0, at_s, 1e-3))
    assert links.shape == (872_000, 6)
    assert time.process_time() - started_s < 20.0
