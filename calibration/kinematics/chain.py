"""A serial arm of any joints in modified Denavit–Hartenberg parameters: its frames, and the levers of its joints.

The transform of joint i is T_i = Rx(α_i) Ry(β_i) Tx(a_i) Rz(θ_i) Tz(d_i), with θ_i = sign · q_i + offset for a
revolute joint and d_i = sign · q_i + d for a prismatic one. With β = 0, as every drawing has it, these are Craig's
parameters (Introduction to Robotics, section 3.4); β is what nearly parallel axes need beside α (Hayati 1983).
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

JointKind = Literal["revolute", "prismatic"]

_IN_CACHE = 1000
"""Poses whose frames fit into a processor's cache."""


@dataclass(frozen=True)
class Joint:
    """One joint.

    Attributes:
        name: as bodies name it.
        kind: q is an angle in deg, or a length in mm.
        alpha_deg: twist from the joint before.
        a_mm: distance of the axes.
        theta_offset_deg: angle at q = 0.
        d_mm: offset along the axis at q = 0.
        sign: 1 or -1.
        low: smallest q, deg or mm.
        high: largest q, deg or mm.
        beta_deg: tilt about y after the twist.
    """

    name: str
    kind: JointKind
    alpha_deg: float
    a_mm: float
    theta_offset_deg: float
    d_mm: float
    sign: float
    low: float
    high: float
    beta_deg: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in get_args(JointKind):
            known = ", ".join(get_args(JointKind))
            raise KinematicsError(f"joint {self.name}: kind {self.kind!r} is unknown: use one of {known}")
        if abs(self.sign) != 1.0:
            raise KinematicsError(f"joint {self.name}: its sign is {self.sign:g}: use 1 or -1")
        if not self.low <= self.high:
            raise KinematicsError(
                f"joint {self.name}: its range {self.low:g}…{self.high:g} is empty: exchange the ends"
            )

    @property
    def unit(self) -> Literal["deg", "mm"]:
        """Of q."""
        return "deg" if self.kind == "revolute" else "mm"

    @property
    def longest_mm(self) -> float:
        """Largest offset along the axis, mm."""
        if self.kind == "revolute":
            return abs(self.d_mm)
        return max(abs(self.d_mm + self.sign * q) for q in (self.low, self.high))

    @property
    def parallel(self) -> bool:
        """Its axis is parallel to that of the joint before."""
        twists = (math.sin(math.radians(angle)) for angle in (self.alpha_deg, self.beta_deg))
        return all(math.isclose(sine, 0.0, abs_tol=1e-12) for sine in twists)


@dataclass(frozen=True)
class Chain:
    """A serial arm; frame 0 is its base, frame i that of joint i.

    Attributes:
        joints: from the base outwards.
    """

    joints: tuple[Joint, ...]

    def frame_of(self, name: str) -> int:
        """Return the number of a frame by its joint's name, or "base".

        Raises:
            KinematicsError: there is no such joint.
        """
        names = ["base", *(joint.name for joint in self.joints)]
        if name not in names:
            raise KinematicsError(f"frame {name!r} is unknown: use one of {', '.join(names)}")
        return names.index(name)

    def frames(self, poses: Floats) -> Floats:
        """Return the frames at poses.

        Args:
            poses: joints, deg or mm, shape (n, joints).

        Returns:
            Homogeneous transforms into the base, lengths in mm, shape (joints + 1, n, 4, 4).
        """
        found = np.empty((len(self.joints) + 1, len(poses), 4, 4))
        found[0] = np.eye(4)
        for i, (joint, fixed) in enumerate(zip(self.joints, self.fixed, strict=True)):
            np.matmul(found[i], fixed @ _moved(joint, poses[:, i]), out=found[i + 1])
        return found

    def flange(self, poses: Floats) -> Floats:
        """Return the last frame at poses; of many poses in a tenth of the time that all frames take.

        Args:
            poses: joints, deg or mm, shape (n, joints).

        Returns:
            Homogeneous transforms into the base, lengths in mm, shape (n, 4, 4).
        """
        found = np.zeros((len(poses), 4, 4))
        found[:, 3, 3] = 1.0
        for first in range(0, len(poses), _IN_CACHE):
            part = slice(first, first + _IN_CACHE)
            axes, origin_mm = self._last(poses[part])
            found[part, :3, :3] = axes.transpose(2, 1, 0)
            found[part, :3, 3] = origin_mm.T
        return found

    def _last(self, poses: Floats) -> tuple[Floats, Floats]:
        """Return axes of the last frame, shape (axis, 3, n), and its origin, shape (3, n)."""
        axes = np.repeat(np.eye(3)[:, :, None], len(poses), axis=2)
        origin = np.zeros((3, len(poses)))
        for i, joint in enumerate(self.joints):
            theta, along = _turn_and_shift(joint, poses[:, i])
            x, y, axes[2] = (self.fixed[i, :3, :3].T @ axes.reshape(3, -1)).reshape(3, 3, -1)
            cos, sin = np.cos(theta), np.sin(theta)
            axes[0], axes[1] = cos * x + sin * y, cos * y - sin * x
            origin += joint.a_mm * x + along * axes[2]
        return axes, origin

    def lever(self, joint: int, frame: int, point_mm: tuple[float, float, float]) -> float:
        """Return an upper bound of how far a point moves when one joint moves by one unit.

        Args:
            joint: number of the joint that moves, from 1.
            frame: number of the frame that the point is fixed to, not before that of the joint.

        Returns:
            mm per deg of a revolute joint, 1 for a prismatic one; it holds at every pose within the joints' ranges.
        """
        if self.joints[joint - 1].kind == "prismatic":
            return 1.0
        between = self.joints[joint:frame]
        if all(other.parallel for other in between):
            # Along parallel axes neither offsets nor heights take a point away from the axis.
            arm_mm = sum(abs(other.a_mm) for other in between) + math.hypot(*point_mm[:2])
        else:
            arm_mm = sum(math.hypot(other.a_mm, other.longest_mm) for other in between) + math.hypot(
                *point_mm
            )
        return math.radians(arm_mm)

    @cached_property
    def fixed(self) -> Floats:
        """What each joint has before its own motion, Rx(α) Ry(β) Tx(a), shape (joints, 4, 4)."""
        made = np.tile(np.eye(4), (len(self.joints), 1, 1))
        for one, joint in zip(made, self.joints, strict=True):
            cos, sin = math.cos(math.radians(joint.alpha_deg)), math.sin(math.radians(joint.alpha_deg))
            along, across = math.cos(math.radians(joint.beta_deg)), math.sin(math.radians(joint.beta_deg))
            one[:3, :3] = [
                [along, 0.0, across],
                [sin * across, cos, -sin * along],
                [-cos * across, sin, cos * along],
            ]
            one[:3, 3] = joint.a_mm * one[:3, 0]
        return made


def _moved(joint: Joint, q: Floats) -> Floats:
    """Return Rz(θ) Tz(d) of a joint, shape (n, 4, 4)."""
    made = np.zeros((len(q), 4, 4))
    theta, along = _turn_and_shift(joint, q)
    made[:, 0, 0] = made[:, 1, 1] = np.cos(theta)
    made[:, 1, 0] = np.sin(theta)
    made[:, 0, 1] = -made[:, 1, 0]
    made[:, 2, 2] = made[:, 3, 3] = 1.0
    made[:, 2, 3] = along
    return made


def _turn_and_shift(joint: Joint, q: Floats) -> tuple[Floats | float, Floats | float]:
    """Return θ in rad and d in mm of a joint at its values of shape (n,); what it does not move is a number."""
    moved = joint.sign * q
    if joint.kind == "revolute":
        return np.deg2rad(moved + joint.theta_offset_deg), joint.d_mm
    return math.radians(joint.theta_offset_deg), moved + joint.d_mm
