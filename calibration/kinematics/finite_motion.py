"""Small motions of a tool centre point about a pose, exact and without cancellation.

The displacement of a step of 1e-5 mm is not the difference of two places that are metres away from the base: it is
summed up joint by joint, from the tool inwards, each joint turning what lies beyond it about its axis (product of
exponentials; Lynch and Park, Modern Robotics, section 4.1). Increments of joints follow by chord steps.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.jacobian import jacobian
from catseye.calibration.kinematics.types import Bools, Floats

_STEPS = 30
"""Chord steps; motions of 1 mm settle within five."""

_REACHED = 1e-9
"""Part of a motion that may be left where it counts as made."""

_RANK = 1e-9
"""Part of the largest singular value below which a combination of joints moves nothing."""


@dataclass(frozen=True)
class Increments:
    """Joint increments of motions.

    Attributes:
        joints: deg or mm, shape (n, joints).
        reached: they make the motion, shape (n,).
    """

    joints: Floats
    reached: Bools


class FiniteMotion:
    """What joint increments from one pose do to the tool centre point.

    Args:
        chain: the arm.
        pose: joints, deg or mm, shape (joints,).
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.

    Attributes:
        jacobian: of the tool centre point, as `jacobian` returns it, shape (6, joints).
        rank: in how many of six independent ways the joints move it.
    """

    def __init__(self, chain: Chain, pose: Floats, tool: Floats | None = None) -> None:
        frames = chain.frames(pose[None])[:, 0]
        tip_mm = (frames[-1] if tool is None else frames[-1] @ tool)[:3, 3]
        self._turns = [joint.kind == "revolute" for joint in chain.joints]
        self._axes: Floats = frames[1:, :3, 2] * np.array([[joint.sign] for joint in chain.joints])
        self._from_axis_mm: Floats = tip_mm - frames[1:, :3, 3]
        self.jacobian: Floats = jacobian(chain, pose[None], tool)[0]
        lever_mm = max(float(np.linalg.norm(self._from_axis_mm, axis=1).max()), 1.0)
        self._weights: Floats = np.array([1.0] * 3 + [math.radians(lever_mm)] * 3)
        weighted = self._weights[:, None] * self.jacobian
        singular = np.linalg.svd(weighted, compute_uv=False)
        self.rank = int(np.sum(singular > _RANK * singular[0]))
        self._inverse: Floats = np.linalg.pinv(weighted, rcond=_RANK)

    def of(self, increments: Floats) -> Floats:
        """Return the motions of the tool centre point.

        Args:
            increments: of the joints, deg or mm, shape (..., joints).

        Returns:
            Displacement, mm, and rotation vector, deg, along the axes of the base, shape (..., 6).
        """
        moved = np.zeros((*increments.shape[:-1], 3))
        scalar, vector = np.ones(increments.shape[:-1]), np.zeros_like(moved)
        for joint in reversed(range(len(self._turns))):
            axis, step = self._axes[joint], increments[..., joint]
            if not self._turns[joint]:
                moved += step[..., None] * axis
                continue
            half = 0.5 * np.deg2rad(step)
            sine, cosine = np.sin(half), np.cos(half)
            across = _cross(axis, moved + self._from_axis_mm[joint])
            moved += (2.0 * sine * cosine)[..., None] * across
            moved += (2.0 * sine**2)[..., None] * _cross(axis, across)
            # The quaternion of this joint times that of the joints beyond it.
            vector, scalar = (
                cosine[..., None] * vector
                + sine[..., None] * (scalar[..., None] * axis + _cross(axis, vector)),
                cosine * scalar - sine * (vector @ axis),
            )
        return np.concatenate([moved, _rotation_vectors_deg(scalar, vector)], axis=-1)

    def increments_for(self, motions: Floats) -> Increments:
        """Return the joint increments that make motions; where joints are free, the least ones.

        Args:
            motions: displacement, mm, and rotation vector, deg, along the axes of the base, shape (n, 6).
        """
        wanted = np.linalg.norm(self._weights * motions, axis=-1)
        joints = (self._weights * motions) @ self._inverse.T
        for _ in range(_STEPS):
            left = self._weights * (motions - self.of(joints))
            far = np.linalg.norm(left, axis=-1)
            if (far <= 1e-3 * _REACHED * wanted).all():
                break
            joints = joints + left @ self._inverse.T
        return Increments(joints, far <= _REACHED * wanted)


def _cross(axis: Floats, vectors: Floats) -> Floats:
    """Return the product of one axis with many vectors, shape (..., 3)."""
    x, y, z = axis
    found: Floats = vectors @ np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    return found


def _rotation_vectors_deg(scalar: Floats, vector: Floats) -> Floats:
    length = np.linalg.norm(vector, axis=-1)
    angle = 2.0 * np.arctan2(length, scalar)
    per_length = np.divide(angle, length, out=np.full_like(length, 2.0), where=length > 0.0)
    found: Floats = np.rad2deg(per_length[..., None] * vector)
    return found
