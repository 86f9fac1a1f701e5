"""The inverse of a six-axis arm with a spherical wrist, in closed form.

The last three axes meet in the wrist centre, the second and the third are parallel, neighbours are at right angles
otherwise: so are most industrial arms, with offsets of shoulder and elbow. The wrist centre gives the first three
joints in up to four ways (Pieper 1968), the orientation gives the others in two ways each.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.types import Bools, Floats

BRANCHES = 8
"""Two shoulders, two elbows, two wrists, the wrist varying fastest."""

_STRAIGHT = 1e-12
_ROUNDING = 1e-12
_ON_AXIS_MM = 1e-7
"""Distance of the wrist centre from the first axis that counts as none; the flange misses by twice that at most."""

_IN_LINE = 1e-9
"""Bend of the wrist, rad, that counts as none; a flange 1 m from the wrist centre misses by 1e-6 mm."""
_TOO_FAR = 1e-9
"""Cosine beyond 1 by which rounding may take a stretched arm."""


@dataclass(frozen=True)
class Branches:
    """All solutions for poses of the flange.

    Attributes:
        theta: angles of the frames, rad, shape (branches, 6, n); what is not reached has any value.
        reached: shape (branches, n).
        on_first_axis: both shoulders are the same: the wrist centre is on the first axis, and the first joint is
            free, or as near to it as an offset of the shoulder lets it, shape (n,).
        stretched: the two elbows are the same, shape (branches, n).
        in_line: the fourth axis and the sixth are, and only a sum of both joints is determined, shape (branches, n).
    """

    theta: Floats
    reached: Bools
    on_first_axis: Bools
    stretched: Bools
    in_line: Bools


@dataclass(frozen=True)
class SphericalWrist:
    """The geometry that the closed form needs; use `of`.

    Attributes:
        chain: the arm.
    """

    chain: Chain

    @classmethod
    def of(cls, chain: Chain) -> "SphericalWrist | None":
        """Return the closed form of an arm; None where its geometry has none here."""
        joints = chain.joints
        if len(joints) != 6 or any(joint.kind != "revolute" for joint in joints):
            return None
        square = all(_is_zero(math.cos(math.radians(joints[k].alpha_deg))) for k in (1, 4, 5))
        meeting = all(_is_zero(length) for length in (joints[4].a_mm, joints[4].d_mm, joints[5].a_mm))
        made = cls(chain)
        arm = joints[2].a_mm != 0.0 and made._forearm_mm > 0.0
        return made if square and joints[2].parallel and meeting and arm else None

    def branches(self, flange: Floats, reference: Floats) -> Branches:
        """Return all solutions.

        Args:
            flange: the last frame in the base, mm, shape (n, 4, 4).
            reference: angles of the frames that stand where they are free, rad, shape (6, n).
        """
        turn = self._into_first(flange[:, :3, :3].transpose(1, 2, 0))
        x, y, z = self._wrist_centre(flange)
        theta = np.empty((2, 2, 2, 6, len(flange)))
        reached = np.empty((2, 2, 2, len(flange)), dtype=np.bool_)
        stretched, in_line = np.empty_like(reached), np.empty_like(reached)
        away_mm2 = x * x + y * y
        square_mm2, rounding_mm2 = away_mm2 - self._side_mm**2, _ROUNDING * (away_mm2 + 1.0)
        on_axis = np.abs(square_mm2) <= rounding_mm2
        out_mm = np.sqrt(np.maximum(square_mm2, 0.0))
        for shoulder, forward_mm in enumerate((out_mm, -out_mm)):
            first = np.arctan2(y, x) - np.arctan2(self._side_mm, forward_mm)
            first = np.where(away_mm2 <= _ON_AXIS_MM**2, reference[0], first)
            theta[shoulder, :, :, 0] = first
            upright = _turned(turn, first)
            ahead, up = forward_mm - self.chain.joints[1].a_mm, self._s2 * z
            cosine = self._elbow_cosine(ahead, up)
            bend = np.arccos(np.clip(cosine, -1.0, 1.0))
            reached[shoulder] = (square_mm2 >= -rounding_mm2) & (np.abs(cosine) <= 1.0 + _TOO_FAR)
            stretched[shoulder] = np.abs(cosine) >= 1.0 - _STRAIGHT
            for elbow, angle in enumerate((bend, -bend)):
                along = self.chain.joints[2].a_mm + self._forearm_mm * np.cos(angle)
                across = self._k3 * self._forearm_mm * np.sin(angle)
                second, third = np.arctan2(up, ahead) - np.arctan2(across, along), angle - self._forearm_rad
                theta[shoulder, elbow, :, 1], theta[shoulder, elbow, :, 2] = second, third
                in_line[shoulder, elbow] = self._wrist(
                    upright, second + self._k3 * third, reference[3], theta[shoulder, elbow]
                )
        n = len(flange)
        return Branches(
            theta.reshape(BRANCHES, 6, n),
            reached.reshape(BRANCHES, n),
            on_axis,
            stretched.reshape(BRANCHES, n),
            in_line.reshape(BRANCHES, n),
        )

    def why_not(self, flange: Floats) -> str:
        """Return why no branch reaches a pose of the flange, shape (4, 4)."""
        joints = self.chain.joints
        x, y, z = (float(each[0]) for each in self._wrist_centre(flange[None]))
        from_axis_mm = math.hypot(x, y)
        if from_axis_mm < abs(self._side_mm):
            return (
                f"the wrist centre is {from_axis_mm:.6g} mm from the axis of {joints[0].name}, which the shoulder "
                f"keeps it {abs(self._side_mm):.6g} mm away from"
            )
        ahead = math.sqrt(from_axis_mm**2 - self._side_mm**2) - joints[1].a_mm
        distance_mm = math.hypot(ahead, z)
        low_mm, high_mm = (abs(abs(joints[2].a_mm) + way * self._forearm_mm) for way in (-1.0, 1.0))
        return (
            f"the wrist centre is {distance_mm:.6g} mm from the axis of {joints[1].name}, and the arm reaches "
            f"{low_mm:.6g}…{high_mm:.6g} mm"
        )

    def _wrist_centre(self, flange: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the wrist centre in the first joint's frame at angle 0, mm, shape (n,) each."""
        first, last = self.chain.joints[0], self.chain.joints[5]
        x, y, z = self._into_first(flange[:, :3, 3].T - last.d_mm * flange[:, :3, 2].T)
        return x - first.a_mm, y, z - first.d_mm

    def _elbow_cosine(self, ahead: Floats, up: Floats) -> Floats:
        upper_mm, forearm_mm = self.chain.joints[2].a_mm, self._forearm_mm
        cosine: Floats = (ahead**2 + up**2 - upper_mm**2 - forearm_mm**2) / (2.0 * upper_mm * forearm_mm)
        return cosine

    def _wrist(self, upright: Floats, pitch: Floats, fourth: Floats, theta: Floats) -> Bools:
        """Fill in the last three angles of both wrists.

        Args:
            upright: the flange's axes in the frame that turns with the first joint, shape (3, 3, n).
            pitch: of the forearm in that frame, rad, shape (n,).
            fourth: angle that stands where it is free, rad, shape (n,).
            theta: of one shoulder and elbow, filled in, shape (2, 6, n).

        Returns:
            Where the fourth angle is free, shape (n,).
        """
        mx, my, mz = self._into_wrist(upright[:, 0], pitch)
        ax, ay, az = self._into_wrist(upright[:, 2], pitch)
        sine = np.hypot(ax, ay)
        free: Bools = sine < _IN_LINE
        sine[free] = 0.0
        angle4 = np.where(free, fourth, np.arctan2(self._s6 * ay, self._s6 * ax))
        angle5 = np.arctan2(sine, -self._s5 * self._s6 * az)
        c4, s4 = np.cos(angle4), np.sin(angle4)
        cosine6 = np.cos(angle5) * (c4 * mx + s4 * my) + self._s5 * np.sin(angle5) * mz
        angle6 = np.arctan2(self._s5 * self._s6 * (s4 * mx - c4 * my), cosine6)
        # The other wrist is bent the other way, with half a turn before and behind the bend.
        half = np.where(free, 0.0, math.pi)
        theta[0, 3:] = angle4, angle5, angle6
        theta[1, 3:] = angle4 + half, -angle5, angle6 + half
        return free

    def _into_wrist(self, vector: Floats, pitch: Floats) -> tuple[Floats, Floats, Floats]:
        """Return vectors, shape (3, n), in the frame of the fourth joint at angle 0."""
        x, y, z = vector[0], self._s2 * vector[2], -self._s2 * vector[1]
        c, s = np.cos(pitch), np.sin(pitch)
        x, y = c * x + s * y, c * y - s * x
        cos, sin = self._twist34
        return x, cos * y + sin * z, cos * z - sin * y

    def _into_first(self, vectors: Floats) -> Floats:
        """Return vectors, shape (3, ...), in the directions of the first joint's frame at angle 0."""
        alpha = math.radians(self.chain.joints[0].alpha_deg)
        if alpha == 0.0:
            return vectors
        cos, sin = math.cos(alpha), math.sin(alpha)
        x, y, z = vectors
        return np.stack([x, cos * y + sin * z, cos * z - sin * y])

    @cached_property
    def _s2(self) -> float:
        return round(math.sin(math.radians(self.chain.joints[1].alpha_deg)))

    @cached_property
    def _k3(self) -> float:
        return round(math.cos(math.radians(self.chain.joints[2].alpha_deg)))

    @cached_property
    def _s5(self) -> float:
        return round(math.sin(math.radians(self.chain.joints[4].alpha_deg)))

    @cached_property
    def _s6(self) -> float:
        return round(math.sin(math.radians(self.chain.joints[5].alpha_deg)))

    @cached_property
    def _twist34(self) -> tuple[float, float]:
        alpha = math.radians(self.chain.joints[2].alpha_deg + self.chain.joints[3].alpha_deg)
        return math.cos(alpha), math.sin(alpha)

    @cached_property
    def _wrist_in_third_mm(self) -> tuple[float, float, float]:
        """The wrist centre in the frame of the third joint."""
        joint = self.chain.joints[3]
        alpha = math.radians(joint.alpha_deg)
        return joint.a_mm, -math.sin(alpha) * joint.d_mm, math.cos(alpha) * joint.d_mm

    @cached_property
    def _forearm_mm(self) -> float:
        return math.hypot(*self._wrist_in_third_mm[:2])

    @cached_property
    def _forearm_rad(self) -> float:
        x_mm, y_mm, _ = self._wrist_in_third_mm
        return math.atan2(y_mm, x_mm)

    @cached_property
    def _side_mm(self) -> float:
        """How far the wrist centre is beside the plane through the first axis in which the arm moves."""
        _, second, third, *_ = self.chain.joints
        return -self._s2 * (self._k3 * (self._wrist_in_third_mm[2] + third.d_mm) + second.d_mm)


def _is_zero(value: float) -> bool:
    return math.isclose(value, 0.0, abs_tol=1e-12)


def _turned(vectors: Floats, angle: Floats) -> Floats:
    """Return vectors, shape (3, ..., n), in a frame turned about z by angles, rad, shape (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = vectors
    return np.stack([c * x + s * y, c * y - s * x, z])
