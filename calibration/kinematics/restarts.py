"""The inverse without a closed form: Newton steps from a reference, then from places all over the ranges."""

from collections.abc import Iterator

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.jacobian import jacobian
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, turned_nearest, within
from catseye.calibration.kinematics.refinement import refine
from catseye.calibration.kinematics.solution import Inverse, Named
from catseye.calibration.kinematics.types import Floats

_STARTS = 24

_FLAT = 1e-9
"""Smallest singular value of a Jacobian with columns of length 1 below which the arm is singular."""


def by_newton(chain: Chain, flange: Floats, near: Floats, first: int) -> Inverse:
    """Return the joints of poses.

    Args:
        flange: the last frame in the base, mm, shape (n, 4, 4).
        near: joints to begin with, deg or mm, shape (n, joints).
        first: number of the first row, as reasons name it.
    """
    low, high = ranges_of(chain)
    turning = np.array([joint.kind == "revolute" for joint in chain.joints])
    poses = np.full(near.shape, np.nan)
    reasons: dict[int, str] = {}
    left = np.arange(len(near))
    for start in [None, *_places(low, high)]:
        if not left.size:
            break
        begin = near[left] if start is None else np.broadcast_to(start, (len(left), len(low)))
        ended = refine(chain, flange[left], begin)
        q = np.where(turning, turned_nearest(ended.poses, near[left], low, high)[0], ended.poses)
        good = ended.reached & within(q, low, high).all(axis=1)
        poses[left[good]] = q[good]
        for k in map(int, np.flatnonzero(~good)):
            if ended.reached[k]:
                reasons[int(left[k])] = beyond_text(chain, q[k])
            else:
                reasons.setdefault(int(left[k]), _miss_text(ended.miss_mm[k], ended.miss_deg[k]))
        left = left[~good]
    refused = tuple(Named(first + row, reasons[row]) for row in map(int, left))
    return Inverse(poses, refused, _degenerate(chain, poses, first))


def _places(low: Floats, high: Floats) -> Iterator[Floats]:
    """Yield places spread evenly over the ranges: multiples of the powers of a root, without whole numbers.

    Roberts, The unreasonable effectiveness of quasirandom sequences (2018).
    """
    root = 2.0
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (len(low) + 1))
    steps = root ** -np.arange(1.0, len(low) + 1.0)
    for k in range(_STARTS):
        yield low + (high - low) * np.mod(0.5 + (k + 1) * steps, 1.0)


def _miss_text(miss_mm: float, miss_deg: float) -> str:
    return f"no joints found for it; the nearest pose is {miss_mm:.3g} mm and {miss_deg:.3g} deg away"


def _degenerate(chain: Chain, poses: Floats, first: int) -> tuple[Named, ...]:
    rows = np.flatnonzero(np.isfinite(poses).all(axis=1))
    slopes = jacobian(chain, poses[rows])
    slopes /= np.linalg.norm(slopes, axis=1, keepdims=True)
    smallest = np.linalg.svd(slopes, compute_uv=False)[:, -1] if rows.size else np.empty(0)
    reason = "the arm is singular: its joints can move without the last frame"
    return tuple(Named(first + row, reason) for row in map(int, rows[smallest < _FLAT]))
