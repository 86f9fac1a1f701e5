"""Where an arm with given parameters puts its flange and its targets, and how each parameter moves them.

Every parameter turns what is behind it about an axis, or shifts it along one. So the derivatives are exact: an axis
and a point of it for each parameter at each pose, and the cross product with the lever.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.rotations import pose_of, rotation_of
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.parameters import (
    FRAME_PARTS,
    NODE_SPACING_DEG,
    BaseFrame,
    Compliance,
    Harmonic,
    JointTerm,
    Link,
    MapNode,
    Parameter,
    Reversal,
    TargetPlace,
)

_RAD = math.radians(1.0)


@dataclass(frozen=True)
class Commands:
    """Poses of the arm.

    Attributes:
        joints: what moves the arm, deg or mm, shape (n, joints).
        approach: side that each joint came from, 1 from below, −1 from above, shape (n, joints).
        torques_nmm: gravity torques about +z of each joint, shape (n, joints).
    """

    joints: Floats
    approach: Floats
    torques_nmm: Floats

    @classmethod
    def of(cls, arm: SerialArm, joints: Floats, approach: Floats | None = None) -> "Commands":
        """Return poses with the torques that gravity exerts there; approached from below if nothing else is said."""
        sides = np.ones_like(joints) if approach is None else approach
        return cls(joints, sides, arm.torques_nmm(joints))

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self.joints)

    def some(self, chosen: Ints) -> "Commands":
        """Return some of the poses."""
        return Commands(self.joints[chosen], self.approach[chosen], self.torques_nmm[chosen])


@dataclass(frozen=True)
class Motions:
    """What a unit of each parameter does to what is fixed to the flange.

    Attributes:
        direction: axis of the turn (times rad per unit) or of the shift, shape (n, p, 3).
        origin_mm: a point of the axis, shape (n, p, 3).
        turns: it is a turn, shape (p,).
    """

    direction: Floats
    origin_mm: Floats
    turns: Floats

    def of_points(self, places_mm: Floats) -> Floats:
        """Return the derivatives of points, mm per unit, shape (n, 3, p).

        Args:
            places_mm: in the frame of the instrument, shape (n, 3).
        """
        levers = places_mm[:, None, :] - self.origin_mm
        turned = np.cross(self.direction, levers)
        moved = np.where(self.turns[:, None], turned, self.direction)
        return np.asarray(moved.transpose(0, 2, 1))

    def of_rotations(self) -> Floats:
        """Return the derivatives of the flange's orientation as a rotation vector, rad per unit, shape (n, 3, p)."""
        return np.asarray((self.direction * self.turns[:, None]).transpose(0, 2, 1))

    def some(self, chosen: Ints) -> "Motions":
        """Return those of some poses, with repetitions."""
        return Motions(self.direction[chosen], self.origin_mm[chosen], self.turns)


@dataclass(frozen=True)
class Geometry:
    """An arm with parameters.

    Attributes:
        arm: nominal arm.
        start: where a closed form put the base in the frame of the instrument, shape (4, 4).
        parameters: the model's.
        values: theirs, shape (p,).
    """

    arm: SerialArm
    start: Floats
    parameters: Sequence[Parameter]
    values: Floats

    @cached_property
    def chain(self) -> Chain:
        """Joints with the geometry of the parameters."""
        changes: list[dict[str, Any]] = [{} for _ in self.arm.chain.joints]
        for parameter, value in zip(self.parameters, self.values.tolist(), strict=True):
            match parameter.role:
                case Link(number, part):
                    changes[number][part] = value
        return Chain(
            tuple(
                replace(joint, **parts) for joint, parts in zip(self.arm.chain.joints, changes, strict=True)
            )
        )

    @cached_property
    def base_steps(self) -> Floats:
        """How far the base is from where a closed form put it: mm and deg, shape (6,)."""
        steps = np.zeros(6)
        for parameter, value in zip(self.parameters, self.values.tolist(), strict=True):
            match parameter.role:
                case BaseFrame(part):
                    steps[FRAME_PARTS.index(part)] = value
        return steps

    @cached_property
    def base(self) -> Floats:
        """The base in the frame of the instrument, shape (4, 4)."""
        return np.asarray(self.start @ pose_of(self.base_steps[:3], self.base_steps[3:]))

    @cached_property
    def tools(self) -> Floats:
        """The targets' frames in that of the flange, shape (targets, 4, 4)."""
        parts = np.zeros((len(self.arm.targets), 6))
        parts[:, :3] = [target.place_mm for target in self.arm.targets] or np.zeros((0, 3))
        for parameter, value in zip(self.parameters, self.values.tolist(), strict=True):
            match parameter.role:
                case TargetPlace(number, part):
                    parts[number, FRAME_PARTS.index(part)] = value
        return pose_of(parts[:, :3], parts[:, 3:])

    def reached(self, commands: Commands) -> Floats:
        """Return the joints reached: commands plus compliance, reversal and harmonics, shape (n, joints)."""
        found = commands.joints.copy()
        for parameter, value in zip(self.parameters, self.values.tolist(), strict=True):
            role = parameter.role
            if isinstance(role, JointTerm):
                found[:, role.joint] += value * per_unit(role, self.arm.chain.joints[role.joint], commands)
        return found

    def frames(self, commands: Commands) -> Floats:
        """Return base and joints in the frame of the instrument, shape (joints + 1, n, 4, 4)."""
        return np.asarray(self.base @ self.chain.frames(self.reached(commands)))

    def places_mm(self, flange: Floats, target: Ints) -> Floats:
        """Return where targets are.

        Args:
            flange: at each row, in the frame of the instrument, shape (n, 4, 4).
            target: number of each row's target, shape (n,).

        Returns:
            In the frame of the instrument, shape (n, 3).
        """
        turned = np.einsum("nij,nj->ni", flange[:, :3, :3], self.tools[target, :3, 3])
        return np.asarray(turned + flange[:, :3, 3])

    def motions(self, commands: Commands, frames: Floats, first: int) -> Motions:
        """Return what each of the first parameters does; what moves no flange does nothing."""
        shape = (len(commands), first, 3)
        found = Motions(np.zeros(shape), np.zeros(shape), np.zeros(first, dtype=np.bool_))
        for k, parameter in enumerate(self.parameters[:first]):
            role = parameter.role
            match role:
                case BaseFrame(part):
                    found.direction[:, k], found.turns[k] = self._base_axis(part), part.endswith("_deg")
                    found.origin_mm[:, k] = self.base[:3, 3]
                case Link(number, part):
                    found.direction[:, k], found.origin_mm[:, k] = self._link_axis(frames, number, part)
                    found.turns[k] = part.endswith("_deg")
                case Compliance(number) | Reversal(number) | Harmonic(number) | MapNode(number):
                    joint = self.arm.chain.joints[number]
                    turning = joint.kind == "revolute"
                    unit = joint.sign * per_unit(role, joint, commands) * (_RAD if turning else 1.0)
                    found.direction[:, k] = frames[number + 1, :, :3, 2] * unit[:, None]
                    found.origin_mm[:, k] = frames[number + 1, :, :3, 3]
                    found.turns[k] = turning
        return found

    def _base_axis(self, part: str) -> Floats:
        """Return the axis that a parameter of the base shifts along or turns about, rad per deg, shape (3,)."""
        turn = self.start[:3, :3]
        if part.endswith("_mm"):
            return np.asarray(turn[:, "xyz".index(part[0])])
        return np.asarray(_RAD * turn @ turning_axis(self.base_steps[3:], part))

    def _link_axis(self, frames: Floats, number: int, part: str) -> tuple[Floats, Floats]:
        """Return axis (rad per deg, or 1) and origin of a parameter of a joint, shape (n, 3) each."""
        before, behind = frames[number, :, :3], frames[number + 1, :, :3]
        match part:
            case "alpha_deg":
                return _RAD * before[:, :, 0], before[:, :, 3]
            case "beta_deg":
                return _RAD * (before[:, :, :3] @ self.chain.fixed[number, :3, 1]), before[:, :, 3]
            case "a_mm":
                return before[:, :, :3] @ self.chain.fixed[number, :3, 0], before[:, :, 3]
            case "theta_offset_deg":
                return _RAD * behind[:, :, 2], behind[:, :, 3]
            case _:
                return behind[:, :, 2], behind[:, :, 3]


def per_unit(role: JointTerm, joint: Joint, commands: Commands) -> Floats:
    """Return what a unit of a parameter adds to its joint's value, deg or mm, shape (n,)."""
    match role:
        case Compliance(number):
            scale = joint.sign * (1.0 / _RAD if joint.kind == "revolute" else 1.0)
            return np.asarray(scale * commands.torques_nmm[:, number])
        case Reversal(number):
            return 0.5 * commands.approach[:, number]
        case Harmonic(number, order, wave):
            angle = order * _RAD * commands.joints[:, number]
            return np.asarray(np.cos(angle) if wave == "cos" else np.sin(angle))
        case MapNode(number, at_deg, reversal):
            share = np.maximum(1.0 - np.abs(commands.joints[:, number] - at_deg) / NODE_SPACING_DEG, 0.0)
            return np.asarray(share * 0.5 * commands.approach[:, number] if reversal else share)


def turning_axis(angles_deg: Floats, part: str) -> Floats:
    """Return the axis that one of the angles of R = Rz·Ry·Rx turns about, shape (..., 3).

    Args:
        angles_deg: about x, y and z, shape (..., 3).
        part: "rx_deg", "ry_deg" or "rz_deg".
    """
    number = "xyz".index(part[1])
    outer = np.where(np.arange(3) > number, angles_deg, 0.0)
    return np.asarray(rotation_of(outer)[..., number])
