"""Jacobians against differences of products of exponentials."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from catseye.calibration.kinematics.jacobian import jacobian
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.kinematics.types import Floats
from tests.unit.calibration.kinematics.chains import NAMES, chain, poses
from tests.unit.calibration.kinematics.screws import ARMS

TOOL = pose_of(np.array([120.0, -50.0, 200.0]), np.array([10.0, 20.0, -30.0]))
STEP = 1e-3


def difference(name: str, pose: Floats, joint: int, tool: Floats) -> Floats:
    """Return mm and deg per unit of a joint by a central difference."""
    ends = []
    for way in (-0.5, 0.5):
        moved = pose.copy()
        moved[joint] += way * STEP
        ends.append(ARMS[name].forward(moved) @ tool)
    turn = Rotation.from_matrix(ends[1][:3, :3] @ ends[0][:3, :3].T).as_rotvec(degrees=True)
    return np.concatenate([ends[1][:3, 3] - ends[0][:3, 3], turn]) / STEP


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=10)
@given(data=st.data())
def test_a_jacobian_is_the_slope_of_its_pose(name: str, data: st.DataObject) -> None:
    pose = data.draw(poses(name))
    for tool in (None, TOOL):
        (found,) = jacobian(chain(name), pose, tool)
        slopes = [
            difference(name, pose[0], k, np.eye(4) if tool is None else tool) for k in range(pose.shape[1])
        ]
        # Rounding of 1e-12 m over a step of 1e-3, and the third derivative of a circle of 3 m.
        assert found == pytest.approx(np.array(slopes).T, abs=2e-7)
