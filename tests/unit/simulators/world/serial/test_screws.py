"""The screws against the kinematics of calibration: two ways to one pose and to one torque."""

import numpy as np
import pytest

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of, loads_of
from catseye.calibration.kinematics.gravity import Load, gravity_torques
from catseye.simulators.config import SerialJoint, SerialLoad
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.types import Floats
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm

ARMS = ("kr210-r2700", "irb120")


def poses_of(name: str) -> Floats:
    limits = np.array([(joint.low, joint.high) for joint in serial_arm(name).joints])
    return np.random.default_rng(7).uniform(limits[:, 0], limits[:, 1], (200, len(limits)))


@pytest.mark.parametrize("name", [*ARMS, "rh-3frh5515"])
def test_screws_and_kinematics_agree_on_every_frame(name: str) -> None:
    poses = poses_of(name)
    frames = ScrewArm(serial_arm(name).joints).frames(poses)
    chain = chain_of(shipped_arm(name)).frames(poses)
    np.testing.assert_allclose(frames, np.moveaxis(chain, 0, 1), rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("name", ARMS)
def test_screws_and_kinematics_agree_on_holding_torques(name: str) -> None:
    poses, described = poses_of(name), shipped_arm(name)
    arm = serial_arm(name, TOOL)
    loads = (*loads_of(described), Load(TOOL.frame, TOOL.mass_kg, TOOL.centre_mm))
    signs = np.array([joint.sign for joint in arm.joints])
    expected = -signs * gravity_torques(chain_of(described), loads, poses)
    found = ScrewArm(arm.joints, arm.loads).holding_torques(poses)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_an_upright_slide_is_held_by_its_weight() -> None:
    slide = SerialJoint("A", True, 0.0, 0.0, 0.0, 0.0, 1, 0.0, 100.0, 100.0)
    held = ScrewArm([slide], [SerialLoad(1, 2.0, (30.0, 0.0, 0.0))]).holding_torques(
        np.array([[10.0], [70.0]])
    )
    np.testing.assert_allclose(held[:, 0], [2.0 * 9.80665] * 2, atol=1e-12)


def test_frames_of_many_poses_are_those_of_each() -> None:
    poses = np.tile(poses_of("kr210-r2700"), (6, 1))
    screws = ScrewArm(serial_arm("kr210-r2700").joints)
    np.testing.assert_array_equal(screws.last_frame(poses), screws.frames(poses)[:, -1])


def test_a_level_pendulum_is_held_by_its_moment() -> None:
    upright = SerialJoint("A", False, -90.0, 0.0, 0.0, 0.0, 1, -180.0, 180.0, 100.0)
    pendulum = ScrewArm([upright], [SerialLoad(1, 2.0, (500.0, 0.0, 0.0))])
    # Positive turns lower the mass: the drive holds it with -m g r, and upright with nothing.
    held = pendulum.holding_torques(np.array([[0.0], [-90.0]]))
    np.testing.assert_allclose(held[:, 0], [-2.0 * 9.80665 * 0.5, 0.0], atol=1e-12)
