"""Frames of a serial arm against trigonometry by hand, and levers against motions."""

import math

import numpy as np
import pytest

from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.scara.planar import forward

SCARA = Chain(
    (
        Joint("J1", "revolute", 0.0, 0.0, 0.0, 0.0, 1.0, -170.0, 170.0),
        Joint("J2", "revolute", 0.0, 325.0, 0.0, 0.0, 1.0, -145.0, 145.0),
        Joint("J3", "prismatic", 0.0, 225.0, 0.0, 200.0, 1.0, 0.0, 150.0),
        Joint("J4", "revolute", 0.0, 0.0, 0.0, 0.0, 1.0, -360.0, 360.0),
    )
)
WRIST = Chain(
    (
        Joint("A1", "revolute", 0.0, 0.0, 0.0, 300.0, 1.0, -180.0, 180.0),
        Joint("A2", "revolute", -90.0, 50.0, -90.0, 0.0, -1.0, -120.0, 120.0),
        Joint("A3", "revolute", 0.0, 270.0, 0.0, 10.0, 1.0, -120.0, 120.0),
        Joint("A4", "revolute", -90.0, 70.0, 0.0, 302.0, 1.0, -180.0, 180.0),
        Joint("A5", "revolute", 90.0, 0.0, 0.0, 0.0, 1.0, -120.0, 120.0),
        Joint("A6", "revolute", -90.0, 0.0, 180.0, 72.0, 1.0, -360.0, 360.0),
    )
)


def test_frames_of_a_scara_are_those_of_planar_trigonometry() -> None:
    poses = np.array([[0.0, 0.0, 0.0, 0.0], [30.0, -70.0, 50.0, 20.0], [-170.0, 145.0, 150.0, -300.0]])
    frames = SCARA.frames(poses)
    xy = forward(np.deg2rad(poses[:, 0]), np.deg2rad(poses[:, 1]), 325.0, 225.0)
    assert frames[4, :, :2, 3] == pytest.approx(xy)
    assert frames[4, :, 2, 3] == pytest.approx(200.0 + poses[:, 2])
    turn = np.deg2rad(poses[:, 0] + poses[:, 1] + poses[:, 3])
    assert frames[4, :, 0, 0] == pytest.approx(np.cos(turn))
    assert frames[4, :, 1, 0] == pytest.approx(np.sin(turn))


def test_the_first_axis_turns_everything_behind_it() -> None:
    poses = np.array([[angle, 20.0, 30.0, 40.0, 50.0, 60.0] for angle in (0.0, 90.0)])
    rest, turned = WRIST.frames(poses)[6, :, :3, 3]
    assert turned == pytest.approx([-rest[1], rest[0], rest[2]])


def test_a_turned_axis_points_where_its_twist_says() -> None:
    frame = WRIST.frames(np.zeros((1, 6)))[2, 0]
    assert frame[:3, 2] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert frame[:3, 3] == pytest.approx([50.0, 0.0, 300.0])


@pytest.mark.parametrize("chain", [SCARA, WRIST])
def test_no_point_moves_farther_than_its_lever(chain: Chain) -> None:
    rng = np.random.default_rng(4)
    low, high = np.array([(joint.low, joint.high) for joint in chain.joints]).T
    last, point = len(chain.joints), (20.0, -30.0, 40.0)
    for joint in range(1, last + 1):
        poses = rng.uniform(low, high, (200, last))
        moved = poses.copy()
        moved[:, joint - 1] += 0.01
        places = [chain.frames(each)[last, :, :3] @ [*point, 1.0] for each in (poses, moved)]
        rate = np.linalg.norm(places[1] - places[0], axis=1).max() / 0.01
        assert rate <= chain.lever(joint, last, point) * (1.0 + 1e-9)


def test_the_flange_of_many_poses_is_their_last_frame() -> None:
    poses = np.random.default_rng(5).uniform(-100.0, 100.0, (2500, 6))
    # Summed in another order: some units of the last digit of a metre.
    assert np.abs(WRIST.flange(poses) - WRIST.frames(poses)[-1]).max() < 1e-11
    assert WRIST.flange(poses[:0]).shape == (0, 4, 4)


def test_levers_of_parallel_axes_leave_heights_out() -> None:
    assert SCARA.lever(1, 4, (30.0, 0.0, -500.0)) == pytest.approx(math.radians(325.0 + 225.0 + 30.0))
    assert SCARA.lever(3, 4, (30.0, 0.0, 0.0)) == 1.0


def test_an_unknown_joint_is_refused() -> None:
    assert (SCARA.frame_of("base"), SCARA.frame_of("J4")) == (0, 4)
    with pytest.raises(KinematicsError, match="J5"):
        SCARA.frame_of("J5")
