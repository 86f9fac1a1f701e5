"""A serial arm by screws: frames as products of exponentials, gravity as wrenches on the joints' twists.

Each joint turns everything behind it about a line that is fixed in the base while the joints before stand at 0, or
shifts it along that line (Lynch and Park, Modern Robotics, sections 4.1 and 5.2). It is written without the
kinematics that it is to check.
"""

from collections.abc import Sequence

import numpy as np

from catseye.simulators.config import SerialJoint, SerialLoad
from catseye.simulators.world.types import Floats

_GRAVITY_M_S2 = 9.80665
_M_PER_MM = 1e-3
_IN_CACHE = 500
"""Poses whose frames fit into a processor's cache."""


class ScrewArm:
    """Axes, homes and loads of an arm. Values of joints are deg, or mm of those that slide.

    Args:
        joints: from the base outwards.
        loads: masses of links and tool.
    """

    def __init__(self, joints: Sequence[SerialJoint], loads: Sequence[SerialLoad] = ()) -> None:
        home = [np.eye(4)]
        for joint in joints:
            home.append(home[-1] @ _at_zero(joint))
        self._home = np.array(home)
        self._loads = tuple(load for load in loads if load.frame and load.mass_kg)
        # An axis is a direction, counted as the joint counts, and a point on it.
        self._signs = np.array([joint.sign for joint in joints], dtype=np.float64)
        self._axes = self._home[1:, :3, 2] * self._signs[:, None]
        self._points = self._home[1:, :3, 3]
        self._crosses = np.array([_cross(axis) for axis in self._axes])
        self._slides = np.array([joint.prismatic for joint in joints])

    def slides(self, joint: int) -> bool:
        """Return whether a joint slides; its number is counted from 1."""
        return bool(self._slides[joint - 1])

    def frames(self, joints_deg: Floats) -> Floats:
        """Return the frame of each joint.

        Args:
            joints_deg: poses, deg or mm, shape (m, n); fewer joints give the frames of the first ones.

        Returns:
            Homogeneous transforms into the base, mm, shape (m, n + 1, 4, 4); the first is the base.
        """
        count = joints_deg.shape[1]
        turned_deg = np.where(self._slides[:count], 0.0, joints_deg)
        turns = _turns(self._crosses[:count], self._points[:count], np.deg2rad(turned_deg))
        turns[..., :3, 3] += (joints_deg - turned_deg)[..., None] * self._axes[:count]
        frames = np.empty((len(joints_deg), count + 1, 4, 4))
        frames[:, 0] = moved = np.eye(4)
        for k in range(count):
            moved = moved @ turns[:, k]
            frames[:, k + 1] = moved @ self._home[k + 1]
        return frames

    def last_frame(self, joints_deg: Floats) -> Floats:
        """Return the last of the frames at poses, of many in less time than all frames, shape (m, 4, 4)."""
        found = np.empty((len(joints_deg), 4, 4))
        for first in range(0, len(joints_deg), _IN_CACHE):
            part = slice(first, first + _IN_CACHE)
            found[part] = self.frames(joints_deg[part])[:, -1]
        return found

    def axes(self, joints_deg: Floats) -> tuple[Floats, Floats]:
        """Return the joints' axes at poses, counted as the joints count.

        Returns:
            Directions and points on them, mm, shape (m, n, 3) each.
        """
        frames = self.frames(joints_deg)[:, 1:]
        return frames[..., :3, 2] * self._signs[:, None], frames[..., :3, 3]

    def holding_torques(self, joints_deg: Floats) -> Floats:
        """Return the torques with which drives hold links and tool against gravity, in the joints' own directions.

        Args:
            joints_deg: poses, deg or mm, shape (m, n).

        Returns:
            N m, or N of joints that slide, shape (m, n).
        """
        frames = self.frames(joints_deg)
        directions, points = self.axes(joints_deg)
        torques = np.zeros(joints_deg.shape)
        for load in self._loads:
            centre = frames[:, load.frame] @ np.array([*load.centre_mm, 1.0])
            weight = np.array([0.0, 0.0, -_GRAVITY_M_S2 * load.mass_kg])
            moment = _M_PER_MM * np.cross(centre[:, :3], weight)
            # The power of the wrench (moment, weight) on a joint's unit twist (ω, -ω × p), or (0, v) where it slides.
            sliding = self._slides[:, None]
            linear = np.where(sliding, directions, -_M_PER_MM * np.cross(directions, points))
            angular = np.where(sliding, 0.0, directions)
            power = np.einsum("mnk,mk->mn", angular, moment) + linear @ weight
            torques[:, : load.frame] -= power[:, : load.frame]
        return torques


def _at_zero(joint: SerialJoint) -> Floats:
    """Return the frame of a joint at 0 in that of the joint before."""
    crosses = np.array([_cross(axis) for axis in np.eye(3)])
    angles = np.deg2rad([[joint.alpha_deg, joint.beta_deg, joint.theta_offset_deg]])
    twisted, tilted, turned = _turns(crosses, np.zeros((3, 3)), angles)[0]
    twisted = twisted @ tilted
    twisted[:3, 3] = twisted[:3, 0] * joint.a_mm
    turned[2, 3] = joint.d_mm
    placed: Floats = twisted @ turned
    return placed


def _cross(axis: Floats) -> Floats:
    """Return the matrix of a cross product by an axis from the left."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _turns(crosses: Floats, points: Floats, angles_rad: Floats) -> Floats:
    """Return rotations about lines by Rodrigues' formula, shape (m, n, 4, 4).

    Args:
        crosses: matrices of the cross products by their directions, shape (n, 3, 3).
        points: on them, shape (n, 3).
        angles_rad: shape (m, n).
    """
    turned = np.zeros((*angles_rad.shape, 4, 4))
    sine, versine = np.sin(angles_rad)[..., None, None], 1.0 - np.cos(angles_rad)[..., None, None]
    turned[..., :3, :3] = np.eye(3) + sine * crosses + versine * (crosses @ crosses)
    turned[..., :3, 3] = points - (turned[..., :3, :3] @ points[..., None])[..., 0]
    turned[..., 3, 3] = 1.0
    return turned
