"""The closed form's branches: the one within the joints' ranges that is nearest to a reference."""

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, turned_nearest
from catseye.calibration.kinematics.solution import Inverse, Named
from catseye.calibration.kinematics.spherical_wrist import Branches, SphericalWrist
from catseye.calibration.kinematics.types import Bools, Floats, Ints


def in_closed_form(closed: SphericalWrist, flange: Floats, near: Floats, first: int) -> Inverse:
    """Return the joints of poses.

    Args:
        flange: the last frame in the base, mm, shape (n, 4, 4).
        near: reference, deg, shape (n, 6).
        first: number of the first row, as reasons name it.
    """
    chain = closed.chain
    sign, offset = np.array([(joint.sign, joint.theta_offset_deg) for joint in chain.joints]).T[:, :, None]
    low, high = (ends[:, None] for ends in ranges_of(chain))
    branches = closed.branches(flange, np.deg2rad(sign * near.T + offset))
    q, inside = turned_nearest(np.rad2deg(sign) * branches.theta - sign * offset, near.T, low, high)
    allowed = branches.reached & inside.all(axis=1)
    change = q - near.T
    best = np.argmin(np.where(allowed, np.einsum("bjn,bjn->bn", change, change), np.inf), axis=0)
    found: Bools = np.any(allowed, axis=0)
    poses = np.where(found, np.take_along_axis(q, best[None, None], axis=0)[0], np.nan).T
    refused = tuple(
        Named(first + row, _refusal(closed, flange[row], branches.reached[:, row], q[:, :, row]))
        for row in map(int, np.flatnonzero(~found))
    )
    return Inverse(np.ascontiguousarray(poses), refused, _singular(chain, branches, best, found, first))


def _refusal(closed: SphericalWrist, flange: Floats, reached: Bools, q: Floats) -> str:
    """Return why a row has no solution: its flange, the branches that reach it, their joints (branches, 6)."""
    if not reached.any():
        return closed.why_not(flange)
    low, high = ranges_of(closed.chain)
    beyond = np.maximum(low - q, q - high).max(axis=1)
    return beyond_text(closed.chain, q[int(np.argmin(np.where(reached, beyond, np.inf)))])


def _singular(chain: Chain, branches: Branches, best: Ints, found: Bools, first: int) -> tuple[Named, ...]:
    one, four, six = chain.joints[0].name, chain.joints[3].name, chain.joints[5].name
    in_line, stretched = (
        np.take_along_axis(each, best[None], axis=0)[0] for each in (branches.in_line, branches.stretched)
    )
    cases = (
        (
            branches.on_first_axis,
            f"both shoulders are the same: the wrist centre cannot be nearer to the axis of {one}",
        ),
        (stretched, "the arm is stretched or folded: both elbows are the same"),
        (in_line, f"{four} and {six} are in line, and {four} stays at the reference"),
    )
    return tuple(
        Named(first + row, "; ".join(text for where, text in cases if where[row]))
        for row in map(int, np.flatnonzero(found & (branches.on_first_axis | stretched | in_line)))
    )
