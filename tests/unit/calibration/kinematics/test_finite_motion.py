"""Motions about a pose, against products of exponentials, and against the inverse that knows absolute poses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.kinematics.finite_motion import FiniteMotion
from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.rotations import pose_of, rotation_vectors_deg
from catseye.calibration.kinematics.types import Floats
from tests.unit.calibration.kinematics.chains import NAMES, chain, poses
from tests.unit.calibration.kinematics.screws import ARMS

TOOL = pose_of(np.array([30.0, -20.0, 150.0]), np.array([10.0, 20.0, -30.0]))
POSE = np.array([20.0, -80.0, 95.0, 15.0, 30.0, -40.0])


def motion_by_screws(name: str, start: Floats, increments: Floats) -> Floats:
    """Return displacement and rotation vector between two absolute poses of the tool."""
    before, after = ARMS[name].forward(start) @ TOOL, ARMS[name].forward(start + increments) @ TOOL
    turn = after[:3, :3] @ before[:3, :3].T
    return np.concatenate([after[:3, 3] - before[:3, 3], rotation_vectors_deg(turn[None])[0]])


@pytest.mark.parametrize("name", NAMES)
@given(st.data(), st.integers(0, 2**32 - 1))
def test_motion_is_that_between_absolute_poses(name: str, data: st.DataObject, seed: int) -> None:
    start = data.draw(poses(name))[0]
    increments = np.random.default_rng(seed).normal(0.0, 5.0, start.size)
    found = FiniteMotion(chain(name), start, TOOL).of(increments)
    assert np.abs(found - motion_by_screws(name, start, increments)).max() < 1e-8


def test_motions_as_small_as_a_picometre_keep_their_digits() -> None:
    motion = FiniteMotion(chain("kr210-r2700"), POSE, TOOL)
    increments = np.array([1.0, -2.0, 3.0, -1.0, 2.0, 1.0]) * 1e-12
    by_jacobian = motion.jacobian @ increments
    assert np.abs(motion.of(increments) / by_jacobian - 1.0).max() < 1e-9


def test_increments_make_steps_of_any_size_exactly() -> None:
    motion = FiniteMotion(chain("kr210-r2700"), POSE, TOOL)
    wanted = np.outer(10.0 ** np.arange(1.0, -8.0, -1.0), [0.6, -0.8, 0.0, 0.0, 0.0, 0.01])
    found = motion.increments_for(wanted)
    assert found.reached.all()
    assert (np.abs(motion.of(found.joints) - wanted).max(axis=1) < 1e-11 * wanted[:, 0]).all()


def test_increments_are_those_of_the_closed_form() -> None:
    arm = chain("kr210-r2700")
    steps = np.outer(np.geomspace(1.0, 20.0, 5), [1.0, 0.5, -0.7])
    targets = np.repeat(arm.flange(POSE[None]) @ TOOL, 5, axis=0)
    targets[:, :3, 3] += steps
    absolute = inverse_kinematics(arm, targets, POSE, TOOL).required()
    wanted = np.concatenate([steps, np.zeros((5, 3))], axis=1)
    found = FiniteMotion(arm, POSE, TOOL).increments_for(wanted)
    assert np.abs(POSE + found.joints - absolute).max() < 1e-9


def test_a_motion_that_an_arm_lacks_is_not_reached() -> None:
    motion = FiniteMotion(chain("rh-3frh5515"), np.array([20.0, 60.0, 100.0, 0.0]))
    found = motion.increments_for(np.eye(6) * 0.1)
    assert motion.rank == 4
    assert found.reached.tolist() == [True, True, True, False, False, True]


def test_a_singular_wrist_cannot_keep_the_orientation() -> None:
    motion = FiniteMotion(chain("kr210-r2700"), np.array([0.0, -80.0, 95.0, 0.0, 0.0, 0.0]))
    found = motion.increments_for(np.eye(6) * 0.1)
    assert motion.rank == 5
    # In the arm's plane it moves freely; across it, two of Y, RX and RZ together are left, none alone.
    assert found.reached.tolist() == [True, False, True, False, True, False]


def test_free_joints_stay_where_they_are() -> None:
    motion = FiniteMotion(chain("kr210-r2700"), np.array([0.0, -80.0, 95.0, 0.0, 0.0, 0.0]))
    found = motion.increments_for(np.eye(6)[:1] * 0.1)
    assert np.abs(found.joints[0, [0, 3, 5]]).max() < 1e-12
