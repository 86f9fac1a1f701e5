"""The geometric Jacobian of a serial arm: how its tool centre point moves with each joint."""

import math

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.types import Floats


def jacobian(chain: Chain, poses: Floats, tool: Floats | None = None) -> Floats:
    """Return the geometric Jacobians at the tool centre point.

    Times a change of the joints they give the change of place and, as a rotation vector, of orientation, both along
    the axes of the base.

    Args:
        poses: joints, deg or mm, shape (n, joints).
        tool: homogeneous transform of the tool centre point in the last frame, mm, shape (4, 4); that frame itself
            without one.

    Returns:
        Three rows in mm, three in deg, each per deg or mm of the joint, shape (n, 6, joints).
    """
    frames = chain.frames(poses)
    return jacobian_of_frames(chain, frames, frames[-1] if tool is None else frames[-1] @ tool)


def jacobian_of_frames(chain: Chain, frames: Floats, tip: Floats) -> Floats:
    """Return the geometric Jacobians from frames that are known already.

    Args:
        frames: as `Chain.frames` returns them, shape (joints + 1, n, 4, 4).
        tip: the tool centre point in the base, shape (n, 4, 4).
    """
    found = np.zeros((len(tip), 6, len(chain.joints)))
    for i, joint in enumerate(chain.joints):
        axis = joint.sign * frames[i + 1, :, :3, 2]
        if joint.kind == "prismatic":
            found[:, :3, i] = axis
        else:
            found[:, :3, i] = math.radians(1.0) * np.cross(axis, tip[:, :3, 3] - frames[i + 1, :, :3, 3])
            found[:, 3:, i] = axis
    return found
