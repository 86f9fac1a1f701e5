"""The inverse of a serial arm for many poses at once: in closed form where there is one, by Newton steps elsewhere.

Of all solutions of the closed form within the joints' ranges the one nearest to a reference is taken; Newton steps
lead from the reference to one on its side, as a rule. What is not reached, and where joints are free, is named row by
row.
"""

import numpy as np

from catseye.calibration.kinematics.branch_choice import in_closed_form
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.restarts import by_newton
from catseye.calibration.kinematics.rotations import inverted, require_poses
from catseye.calibration.kinematics.solution import Inverse
from catseye.calibration.kinematics.spherical_wrist import SphericalWrist
from catseye.calibration.kinematics.types import Floats

_AT_ONCE = 2000
"""Poses that are solved together: memory stays bounded, and arrays in the cache."""


def inverse_kinematics(
    chain: Chain, targets: Floats, reference: Floats, tool: Floats | None = None
) -> Inverse:
    """Return the joints that bring the tool centre point to targets.

    Args:
        targets: in the base, homogeneous transforms, mm, shape (n, 4, 4).
        reference: joints that the solution is to be near, and that stand where a joint is free, deg or mm, shape
            (joints,) or (n, joints).
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.

    Raises:
        KinematicsError: an array has another shape or is no rigid transform.
    """
    require_poses(targets, "targets")
    if tool is not None:
        require_poses(tool[None], "tool")
    near = _references(chain, reference, len(targets))
    flange = targets if tool is None else targets @ inverted(tool)
    closed = SphericalWrist.of(chain)
    solved = [
        by_newton(chain, flange[part], near[part], part.start)
        if closed is None
        else in_closed_form(closed, flange[part], near[part], part.start)
        for part in (slice(k, k + _AT_ONCE) for k in range(0, max(len(targets), 1), _AT_ONCE))
    ]
    return Inverse(
        np.concatenate([one.poses for one in solved]),
        tuple(named for one in solved for named in one.refused),
        tuple(named for one in solved for named in one.singular),
    )


def _references(chain: Chain, reference: Floats, n: int) -> Floats:
    joints = len(chain.joints)
    if reference.shape not in ((joints,), (n, joints)):
        raise KinematicsError(
            f"reference: shape {reference.shape} instead of ({joints},) or ({n}, {joints}): "
            "give a value for each joint"
        )
    if not np.isfinite(reference).all():
        raise KinematicsError("reference: a joint is not finite: give deg or mm")
    return np.broadcast_to(reference, (n, joints))
