"""Rows of many draws of one set of poses at once, for the Monte Carlo.

The gradient needs no dense Jacobian: the pulls of the rows on a pose are a force and a moment there, and what a
parameter does is a turn about an axis or a shift along one. Arrays end in (poses, draws).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Joint
from catseye.calibration.kinematics.rotations import pose_of, rotation_of, rotation_vectors_deg
from catseye.calibration.serial_arm.geometry import per_unit, turning_axis
from catseye.calibration.serial_arm.model import LEVER_MM, ArmModel
from catseye.calibration.serial_arm.parameters import (
    FRAME_PARTS,
    LINK_PARTS,
    AnchorPlace,
    BaseFrame,
    DeadPath,
    JointTerm,
    Link,
    TargetPlace,
)

_RAD = float(np.deg2rad(1.0))


@dataclass(frozen=True)
class BatchedArm:
    """Rows of a Monte Carlo.

    Attributes:
        model: of a single draw.
    """

    model: ArmModel

    @property
    def measured_mm(self) -> Floats:
        """What is taken from the residuals, shape (n,)."""
        return np.zeros(self.model.rows) if self.model.errors_mm is None else self.model.errors_mm

    def with_measured(self, measured_mm: Floats) -> ArmModel:
        """Return the model of a draw, shape (n,)."""
        return replace(self.model, errors_mm=measured_mm)

    def gradient(self, values: Floats, measured_mm: Floats, forces: Callable[[Floats], Floats]) -> Floats:
        """Return half the gradients of the sums of squares, JᵀV⁻¹r.

        Args:
            values: of the parameters, one column a draw, shape (p, b).
            measured_mm: one column a draw, shape (n, b).
            forces: returns V⁻¹ times residuals, shape (n, b).
        """
        drawn = _Draws(self.model, values)
        pulls = forces(drawn.residuals() - measured_mm)
        return drawn.gradient(pulls)

    def residuals(self, values: Floats) -> Floats:
        """Return predicted minus measured of draws of shape (p, b), mm, shape (n, b)."""
        return _Draws(self.model, values).residuals()


@dataclass(frozen=True)
class _Frame:
    """A frame in that of the instrument: axes and origin, mm, shape (3, poses, draws) each."""

    x: Floats
    y: Floats
    z: Floats
    origin: Floats


@dataclass(frozen=True)
class _Moved:
    """A joint: the frame before it, after its twist, and behind it."""

    before: _Frame
    twisted: _Frame
    behind: _Frame


@dataclass(frozen=True)
class _Pulls:
    """What rows pull with on the flange of each pose: force and moment about the instrument's origin."""

    force: Floats
    moment: Floats

    def about(self, origin: Floats) -> Floats:
        """Return the moment about another place, shape (3, poses, draws)."""
        return self.moment - _cross(origin, self.force)


class _Draws:
    """One batch of draws."""

    def __init__(self, model: ArmModel, values: Floats) -> None:
        self.model, self.values = model, values
        held = np.repeat(np.array([value for _, value in model.held])[:, None], values.shape[1], axis=1)
        self.all = [*model.chosen, *(parameter for parameter, _ in model.held)]
        self.every = np.vstack([values, held.reshape(-1, values.shape[1])])

    def residuals(self) -> Floats:
        rows = self.model.measurements.points
        missed = self.point_places - rows.place_mm.T[:, :, None]
        along = np.einsum("nij,jnb->nib", self.model.axes[1], missed)
        found = [along.reshape(-1, self.draws), self._turned()]
        distances = self.model.measurements.distances
        if len(distances.pose):
            length = np.sqrt(np.sum(self.beams**2, axis=0))
            found.append(
                length - self._dead_paths()[distances.segment] - distances.distance_mm[:, None],
            )
        known = [self.values[k] - self.model.chosen[k].nominal for k, _ in self.model.known]
        return np.vstack([*found, np.array(known).reshape(-1, self.draws)])

    def gradient(self, rows: Floats) -> Floats:
        """Return the gradient, shape (p, b), from the pulls of rows, shape (n, b)."""
        measured = self.model.measurements
        points, turned = 3 * len(measured.points.pose), 3 * len(measured.orientations.pose)
        on_points = np.einsum("nij,nib->jnb", self.model.axes[1], rows[:points].reshape(-1, 3, self.draws))
        torques = LEVER_MM * rows[points : points + turned].reshape(-1, 3, self.draws).transpose(1, 0, 2)
        along = rows[points + turned : self.model.measured_rows]
        on_ends = np.zeros((3, 0, self.draws))
        if len(measured.distances.pose):
            on_ends = along * self.beams / np.sqrt(np.sum(self.beams**2, axis=0))
        pulls = self._pulls(on_points, on_ends, torques)
        found = np.zeros_like(self.values)
        for k, parameter in enumerate(self.model.chosen):
            match parameter.role:
                case BaseFrame(part):
                    found[k] = self._of_base(part, pulls)
                case Link(number, part):
                    found[k] = self._of_link(self.joints[number], part, pulls)
                case TargetPlace(number, part):
                    found[k] = self._of_target(number, part, (on_points, on_ends, torques))
                case AnchorPlace(number, part):
                    concerned = measured.distances.anchor == number
                    found[k] = -on_ends["xyz".index(part[0]), concerned].sum(axis=0)
                case DeadPath(number):
                    found[k] = -along[measured.distances.segment == number].sum(axis=0)
                case role:
                    found[k] = self._of_joint(role, pulls)
        for row, (k, _) in enumerate(self.model.known, self.model.measured_rows):
            found[k] += rows[row]
        return found

    @property
    def draws(self) -> int:
        return int(self.values.shape[1])

    @cached_property
    def joints(self) -> list[_Moved]:
        """Every joint at every pose, with the geometry of every draw."""
        before = _frame(np.moveaxis(self.base[:, :3], 0, -1)[:, :, None, :])
        found = []
        for number, joint in enumerate(self.model.arm.chain.joints):
            found.append(self._moved(before, number, joint))
            before = found[-1].behind
        return found

    @cached_property
    def base(self) -> Floats:
        """Base in the frame of the instrument, shape (b, 4, 4)."""
        return np.asarray(self.model.start @ pose_of(self.base_steps[:, :3], self.base_steps[:, 3:]))

    @cached_property
    def base_steps(self) -> Floats:
        steps = np.zeros((self.draws, 6))
        for parameter, value in zip(self.all, self.every, strict=True):
            match parameter.role:
                case BaseFrame(part):
                    steps[:, FRAME_PARTS.index(part)] = value
        return steps

    @cached_property
    def tools(self) -> Floats:
        """Places and angles of the targets on the flange, shape (targets, 6, b)."""
        parts = np.zeros((len(self.model.arm.targets), 6, self.draws))
        parts[:, :3] = np.array([one.place_mm for one in self.model.arm.targets])[:, :, None]
        for parameter, value in zip(self.all, self.every, strict=True):
            match parameter.role:
                case TargetPlace(number, part):
                    parts[number, FRAME_PARTS.index(part)] = value
        return parts

    @cached_property
    def point_places(self) -> Floats:
        rows = self.model.measurements.points
        return self._places(rows.pose, rows.target)

    @cached_property
    def end_places(self) -> Floats:
        rows = self.model.measurements.distances
        return self._places(rows.pose, rows.target)

    @cached_property
    def beams(self) -> Floats:
        """From anchors to targets, mm, shape (3, rows, b)."""
        rows = self.model.measurements.distances
        places = np.array([one.place_mm for one in rows.anchors])[:, :, None] + np.zeros(self.draws)
        for parameter, value in zip(self.all, self.every, strict=True):
            match parameter.role:
                case AnchorPlace(number, part):
                    places[number, "xyz".index(part[0])] = value
        return np.asarray(self.end_places - places[rows.anchor].transpose(1, 0, 2))

    def _dead_paths(self) -> Floats:
        found = np.zeros((len(self.model.measurements.distances.segments) + 1, self.draws))
        for parameter, value in zip(self.all, self.every, strict=True):
            match parameter.role:
                case DeadPath(number):
                    found[number] = value
        return found

    def _moved(self, before: _Frame, number: int, joint: Joint) -> _Moved:
        parts = {part: np.full(self.draws, getattr(joint, part)) for part in LINK_PARTS}
        q = np.repeat(self.model.measurements.commands.joints[:, number, None], self.draws, axis=1)
        for parameter, value in zip(self.all, self.every, strict=True):
            match parameter.role:
                case Link(owner, part) if owner == number:
                    parts[part] = value
                case role if isinstance(role, JointTerm) and role.joint == number:
                    q += self._per_unit(role)[:, None] * value
        still = np.zeros(self.draws)
        twist = rotation_of(np.column_stack([parts["alpha_deg"], still, still]))
        tilt = rotation_of(np.column_stack([still, parts["beta_deg"], still]))
        fixed = np.moveaxis(twist @ tilt, 0, -1)
        along_x, across, normal = (
            before.x * fixed[0, k] + before.y * fixed[1, k] + before.z * fixed[2, k] for k in range(3)
        )
        twisted = _Frame(along_x, across, normal, before.origin + parts["a_mm"] * along_x)
        turning = joint.kind == "revolute"
        theta = _RAD * (parts["theta_offset_deg"] + (joint.sign * q if turning else 0.0))
        along = parts["d_mm"] + (0.0 if turning else joint.sign * q)
        cos, sin = np.cos(theta), np.sin(theta)
        x, y = cos * along_x + sin * across, cos * across - sin * along_x
        return _Moved(before, twisted, _Frame(x, y, normal, twisted.origin + along * normal))

    def _per_unit(self, role: JointTerm) -> Floats:
        return per_unit(role, self.model.arm.chain.joints[role.joint], self.model.measurements.commands)

    def _places(self, pose: Ints, target: Ints) -> Floats:
        """Return places of targets, mm, shape (3, rows, b)."""
        flange, (x, y, z) = self.joints[-1].behind, self.tools[target, :3].transpose(1, 0, 2)
        return np.asarray(
            flange.origin[:, pose] + flange.x[:, pose] * x + flange.y[:, pose] * y + flange.z[:, pose] * z
        )

    def _turned(self) -> Floats:
        """Return how far orientations are turned, mm at the lever, shape (3 rows, b)."""
        rows = self.model.measurements.orientations
        if not len(rows.pose):
            return np.zeros((0, self.draws))
        predicted = self._flange_rotation(rows.pose) @ rotation_of(
            self.tools[rows.target, 3:].transpose(0, 2, 1)
        )
        apart = predicted @ rows.rotation.transpose(0, 2, 1)[:, None]
        vectors = rotation_vectors_deg(apart.reshape(-1, 3, 3)).reshape(len(rows.pose), self.draws, 3)
        return np.asarray(vectors.transpose(0, 2, 1).reshape(-1, self.draws) * (_RAD * LEVER_MM))

    def _flange_rotation(self, pose: Ints) -> Floats:
        """Return the flange's rotation at rows, shape (rows, b, 3, 3)."""
        flange = self.joints[-1].behind
        axes = np.stack([np.broadcast_to(axis, flange.x.shape) for axis in (flange.x, flange.y, flange.z)])
        return np.asarray(axes[:, :, pose].transpose(2, 3, 1, 0))

    def _pulls(self, on_points: Floats, on_ends: Floats, torques: Floats) -> _Pulls:
        measured = self.model.measurements
        force = self._at_poses(measured.points.pose, on_points) + self._at_poses(
            measured.distances.pose, on_ends
        )
        moment = self._at_poses(measured.points.pose, _cross(self.point_places, on_points))
        moment += self._at_poses(measured.orientations.pose, torques)
        if len(measured.distances.pose):
            moment += self._at_poses(measured.distances.pose, _cross(self.end_places, on_ends))
        return _Pulls(force, moment)

    def _at_poses(self, pose: Ints, rows: Floats) -> Floats:
        """Return sums over the rows of each pose, shape (3, poses, b)."""
        count = len(self.model.measurements.commands)
        onto = sparse.csr_array((np.ones(len(pose)), (pose, np.arange(len(pose)))), shape=(count, len(pose)))
        return np.stack([onto @ part for part in rows])

    def _of_base(self, part: str, pulls: _Pulls) -> Floats:
        turn = self.model.start[:3, :3]
        if part.endswith("_mm"):
            return np.asarray(turn[:, "xyz".index(part[0])] @ pulls.force.sum(axis=1))
        axis = turn @ turning_axis(self.base_steps[:, 3:], part).T
        about = pulls.about(self.joints[0].before.origin)
        return np.asarray(_RAD * np.einsum("ib,inb->b", axis, about))

    def _of_link(self, joint: _Moved, part: str, pulls: _Pulls) -> Floats:
        match part:
            case "alpha_deg":
                return _RAD * _along(joint.before.x, pulls.about(joint.before.origin))
            case "beta_deg":
                return _RAD * _along(joint.twisted.y, pulls.about(joint.before.origin))
            case "a_mm":
                return _along(joint.twisted.x, pulls.force)
            case "theta_offset_deg":
                return _RAD * _along(joint.behind.z, pulls.about(joint.behind.origin))
            case _:
                return _along(joint.behind.z, pulls.force)

    def _of_joint(self, role: JointTerm, pulls: _Pulls) -> Floats:
        joint, behind = self.model.arm.chain.joints[role.joint], self.joints[role.joint].behind
        turning = joint.kind == "revolute"
        pulled = pulls.about(behind.origin) if turning else pulls.force
        unit = joint.sign * self._per_unit(role) * (_RAD if turning else 1.0)
        return _along(behind.z * unit[:, None], pulled)

    def _of_target(self, number: int, part: str, pulls: tuple[Floats, Floats, Floats]) -> Floats:
        measured, flange = self.model.measurements, self.joints[-1].behind
        on_points, on_ends, torques = pulls
        if part.endswith("_mm"):
            axis = {"x_mm": flange.x, "y_mm": flange.y, "z_mm": flange.z}[part]
            return sum(
                (
                    _along(axis[:, rows.pose[rows.target == number]], pulled[:, rows.target == number])
                    for rows, pulled in ((measured.points, on_points), (measured.distances, on_ends))
                ),
                np.zeros(self.draws),
            )
        concerned = measured.orientations.target == number
        axes = turning_axis(self.tools[number, 3:].T, part)
        turned = self._flange_rotation(measured.orientations.pose[concerned]) @ axes[None, :, :, None]
        return np.asarray(_RAD * np.einsum("nbi,inb->b", turned[..., 0], torques[:, concerned]))


def _frame(columns: Floats) -> _Frame:
    """Return a frame from the columns of its transform, shape (3, 4, poses, draws)."""
    return _Frame(columns[:, 0], columns[:, 1], columns[:, 2], columns[:, 3])


def _along(axis: Floats, pulled: Floats) -> Floats:
    return np.asarray((axis * pulled).sum(axis=(0, 1)))


def _cross(one: Floats, other: Floats) -> Floats:
    return np.stack([one[k - 2] * other[k - 1] - one[k - 1] * other[k - 2] for k in range(3)])
