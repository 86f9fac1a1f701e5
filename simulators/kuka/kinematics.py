"""What the controller believes of its arm: where the flange is, and the joints along a straight line of the tool."""

import numpy as np

from catseye.simulators.config import Joints, SerialArm
from catseye.simulators.kuka.values import ANGLES, PLACE, Structure, frame
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.types import Floats

_CLOSE_MM = 1e-7
_MOST_STEPS = 20
_SINGULAR = 1e4
"""Condition above which an arm counts as singular: a joint would turn through an angle without bound."""

_MM_PER_RAD = 1000.0
"""Weight of an angle against a length when a line is solved."""


class UnsolvableError(Exception):
    """No joints put the flange there."""


class Kinematics:
    """Forward and inverse kinematics of the nominal arm; the tool stands for the flange."""

    def __init__(self, arm: SerialArm) -> None:
        self._screws = ScrewArm(arm.joints)

    def flange(self, joints: Joints) -> Floats:
        """Return the frame of the flange, mm, shape (4, 4)."""
        found: Floats = self._screws.frames(np.array([joints]))[0, -1]
        return found

    def place(self, joints: Joints) -> Structure:
        """Return the frame of the flange as a FRAME: R = Rz(A) Ry(B) Rx(C)."""
        flange = self.flange(joints)
        turn = flange[:3, :3]
        a = np.arctan2(turn[1, 0], turn[0, 0])
        b = np.arctan2(-turn[2, 0], np.hypot(turn[0, 0], turn[1, 0]))
        c = np.arctan2(turn[2, 1], turn[2, 2])
        x, y, z = flange[:3, 3]
        return frame(x, y, z, *np.rad2deg([a, b, c]))

    def stepped(self, measured: Joints, increment_mm: Floats) -> Floats:
        """Return the goal of a straight step: the measured frame, in REALs of 32 bits, and an increment.

        Args:
            measured: joints, deg.
            increment_mm: along the axes of the base, shape (3,).

        Returns:
            Frame, mm, shape (4, 4).
        """
        place = self.place(measured)
        goal = np.eye(4)
        goal[:3, :3] = _orientation(*map(place.number, ANGLES))
        goal[:3, 3] = np.array([place.number(axis) for axis in PLACE]) + increment_mm
        return goal

    def line(self, start: Joints, goal: Floats, count: int) -> Floats:
        """Return joints along the straight line of the flange to a frame; the orientation changes evenly on the way.

        Args:
            start: joints, deg.
            goal: frame, mm, shape (4, 4).
            count: knots, the last one at the goal.

        Returns:
            Joints, deg, shape (count, n).

        Raises:
            UnsolvableError: a place on the line is out of reach, or the arm is too near a singularity.
        """
        here = self.flange(start)
        # A blend of two orientations is none, but what it is turned by is what is solved for.
        targets = here + np.linspace(0.0, 1.0, count + 1)[1:, None, None] * (goal - here)
        joints = np.repeat(np.array(start)[None], count, axis=0)
        for _ in range(_MOST_STEPS):
            left, jacobian = self._linearised(joints, targets)
            if np.abs(left).max() < _CLOSE_MM:
                return joints
            if np.linalg.cond(jacobian).max() > _SINGULAR:
                raise UnsolvableError
            joints = joints + np.rad2deg(np.linalg.solve(jacobian, left[..., None])[..., 0])
        raise UnsolvableError

    def _linearised(self, joints: Floats, targets: Floats) -> tuple[Floats, Floats]:
        """Return what is left to targets, mm, shape (m, 6), and how it depends on the joints, shape (m, 6, n)."""
        flanges = self._screws.frames(joints)[:, -1]
        directions, points = self._screws.axes(joints)
        turned = targets[:, :3, :3] @ flanges[:, :3, :3].transpose(0, 2, 1)
        turn = 0.5 * np.stack(
            [turned[:, i, k] - turned[:, k, i] for i, k in ((2, 1), (0, 2), (1, 0))], axis=1
        )
        left = np.concatenate([targets[:, :3, 3] - flanges[:, :3, 3], _MM_PER_RAD * turn], axis=1)
        linear = np.cross(directions, flanges[:, None, :3, 3] - points)
        jacobian = np.concatenate([linear, _MM_PER_RAD * directions], axis=2).transpose(0, 2, 1)
        return left, jacobian


def _orientation(a_deg: float, b_deg: float, c_deg: float) -> Floats:
    """Return R = Rz(A) Ry(B) Rx(C), shape (3, 3)."""
    (sin_a, sin_b, sin_c), (cos_a, cos_b, cos_c) = (
        turn(np.deg2rad([a_deg, b_deg, c_deg])) for turn in (np.sin, np.cos)
    )
    return np.array(
        [
            [cos_a * cos_b, cos_a * sin_b * sin_c - sin_a * cos_c, cos_a * sin_b * cos_c + sin_a * sin_c],
            [sin_a * cos_b, sin_a * sin_b * sin_c + cos_a * cos_c, sin_a * sin_b * cos_c - cos_a * sin_c],
            [-sin_b, cos_b * sin_c, cos_b * cos_c],
        ]
    )
