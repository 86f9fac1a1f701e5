"""Rows of residuals of a serial arm and their derivatives, as the estimation of the core takes them.

Rows are in the order points (three coordinates each), orientations (three angles each), distances, places known
beforehand. Coordinates whose errors are correlated are turned to the axes of their covariance, where they are not.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.model import Parameters, not_separable
from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.rotations import rotation_vectors_deg
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.closed_form import Start
from catseye.calibration.serial_arm.geometry import Commands, Geometry, Motions, turning_axis
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.parameters import (
    FRAME_PARTS,
    AnchorPlace,
    DeadPath,
    Parameter,
    TargetPlace,
)

LEVER_MM = 100.0
"""An orientation counts like the place of a point so far from the origin of its frame."""

_RAD = float(np.deg2rad(1.0))


@dataclass(frozen=True)
class ArmModel:
    """Measurements of an arm under a choice of parameters.

    Attributes:
        arm: nominal arm.
        start: base in the frame of the instrument where the parameters are zero, shape (4, 4).
        chosen: parameters that are estimated.
        held: parameters that keep values of their own, and these.
        measurements: rows.
        common: errors that rows have in common.
        undetermined: sentence about null directions.
        scatter_mm: standard deviation of rows that state none; what is known beforehand is weighed against it.
        errors_mm: what was drawn of the rows' errors, taken from the residuals, shape (n,); None: nothing.
    """

    arm: SerialArm
    start: Floats
    chosen: tuple[Parameter, ...]
    measurements: Measurements
    held: tuple[tuple[Parameter, float], ...] = ()
    common: tuple[Shared, ...] = ()
    undetermined: Callable[[list[list[str]]], str] = not_separable
    scatter_mm: float = 1.0
    errors_mm: Floats | None = None

    @cached_property
    def parameters(self) -> Parameters:
        """What is estimated."""
        return Parameters(
            names=tuple(one.name for one in self.chosen),
            units=tuple(one.unit for one in self.chosen),
            basis=np.eye(len(self.chosen)),
            unsettled="check units, order and signs of the joints, and the names of the targets",
            undetermined=self.undetermined,
        )

    def start_values(self, start: Start) -> Floats:
        """Return where an iteration starts, shape (p,)."""
        return np.array([start.values.get(one.name, one.nominal) for one in self.chosen])

    @property
    def stated(self) -> bool:
        """The weights are stated uncertainties, not ones."""
        return self.measurements.stated

    @cached_property
    def weights(self) -> Floats:
        """Reciprocal white standard uncertainties, 1/mm, shape (n,)."""
        points, turned, distances = self._rows
        found = np.full(self.rows, 1.0 / self.scatter_mm)
        if self.stated:
            found[: 3 * points] = (1.0 / np.sqrt(self.axes[0])).ravel()
            if self.measurements.orientations.u_deg is not None:
                u_deg = np.repeat(self.measurements.orientations.u_deg, 3)
                found[3 * points : 3 * (points + turned)] = 1.0 / (LEVER_MM * _RAD * u_deg)
            if self.measurements.distances.u_mm is not None:
                first = 3 * (points + turned)
                found[first : first + distances] = 1.0 / self.measurements.distances.u_mm
        for row, (_, u) in zip(range(self.rows - len(self.known), self.rows), self.known, strict=True):
            found[row] = 1.0 / u
        return found

    @cached_property
    def repeats(self) -> Repeats:
        """Rows that measure the same: of one kind, at one command that is approached from the same sides.

        Rows of a point lie along the axes of its own covariance; along these they see the place that repeats share.
        """
        commands = self.measurements.commands
        came = np.column_stack([commands.joints, commands.approach])
        _, same = np.unique(came, axis=0, return_inverse=True)
        points, turned, distances = (
            self.measurements.points,
            self.measurements.orientations,
            self.measurements.distances,
        )
        keys = [
            _keys(0, same[points.pose], points.target).repeat(3, axis=0),
            _keys(1, same[turned.pose], turned.target).repeat(3, axis=0),
            _keys(2, same[distances.pose], distances.target, distances.anchor, distances.segment),
            _keys(3, np.arange(len(self.known))),
        ]
        _, group = np.unique(np.vstack(keys), axis=0, return_inverse=True)
        singly = len(distances.pose) + len(self.known)
        along = [
            self.axes[1].reshape(-1, 3),
            np.tile(np.eye(3), (len(turned.pose), 1)),
            np.tile(np.eye(1, 3), (singly, 1)),
        ]
        return Repeats(np.asarray(group.ravel(), dtype=np.int64), np.vstack(along))

    @property
    def measured_rows(self) -> int:
        """Number of rows that were measured; they stand first."""
        points, turned, distances = self._rows
        return 3 * (points + turned) + distances

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.measured_rows + len(self.known)

    def geometry(self, values: Floats) -> Geometry:
        """Return the arm at values of shape (p,)."""
        parameters = (*self.chosen, *(parameter for parameter, _ in self.held))
        return Geometry(self.arm, self.start, parameters, np.concatenate([values, self._held_values]))

    def residuals(self, values: Floats) -> Floats:
        """Return predicted minus measured at values of shape (p,), mm, shape (n,)."""
        seen = self._seen(values)
        points, distances = self.measurements.points, self.measurements.distances
        flange = seen.frames[-1]
        missed = seen.geometry.places_mm(flange[points.pose], points.target) - points.place_mm
        along = np.einsum("nij,nj->ni", self.axes[1], missed)
        found = [along.ravel(), self._turned(seen.geometry, flange).ravel()]
        if len(distances.pose):
            ends = seen.geometry.places_mm(flange[distances.pose], distances.target)
            apart = np.linalg.norm(ends - self.anchors(values)[distances.anchor], axis=1)
            found.append(apart - self._dead_paths(values)[distances.segment] - distances.distance_mm)
        found.append(np.array([values[k] - self.chosen[k].nominal for k, _ in self.known]))
        predicted = np.concatenate(found)
        return predicted if self.errors_mm is None else predicted - self.errors_mm

    def jacobian(self, values: Floats) -> Floats:
        """Return the derivatives of the residuals, shape (n, p)."""
        seen = self._seen(values)
        points, turned = self.measurements.points, self.measurements.orientations
        moved = self._moved(seen, points.pose, points.target)[0]
        along = np.einsum("nij,njp->nip", self.axes[1], moved)
        size = len(self.chosen)
        found = [along.reshape(-1, size)]
        rotated = seen.motions.some(turned.pose).of_rotations() * LEVER_MM
        self._add_tool_turns(rotated, seen, values)
        found.append(rotated.reshape(-1, size))
        if len(self.measurements.distances.pose):
            found.append(self._distance_rows(seen, values))
        known = np.zeros((len(self.known), size))
        for row, (k, _) in enumerate(self.known):
            known[row, k] = 1.0
        return np.vstack([*found, known])

    def moved(self, values: Floats, commands: Commands, target: int) -> Floats:
        """Return how a target at poses moves with the parameters, mm per unit, shape (n, 3, p)."""
        everywhere = np.arange(len(commands))
        return self._moved(self._seen(values, commands), everywhere, np.full(len(commands), target))[0]

    def white(self, values: Floats) -> tuple[White, ...]:
        """Return the errors that differ from row to row."""
        del values
        return (White("instrument", 1.0 / self.weights),)

    def shared(self, values: Floats) -> tuple[Shared, ...]:
        """Return the errors that rows have in common."""
        del values
        return self.common

    @cached_property
    def pose_of_row(self) -> Ints:
        """Number of each row's pose, shape (n,); −1 of what is known beforehand."""
        measured = self.measurements
        return np.concatenate(
            [
                np.repeat(measured.points.pose, 3),
                np.repeat(measured.orientations.pose, 3),
                measured.distances.pose,
                np.full(len(self.known), -1),
            ]
        )

    @cached_property
    def _rows(self) -> tuple[int, int, int]:
        measured = self.measurements
        return len(measured.points.pose), len(measured.orientations.pose), len(measured.distances.pose)

    @cached_property
    def known(self) -> tuple[tuple[int, float], ...]:
        """Parameters that were measured beforehand, by number, with their standard uncertainties."""
        return tuple((k, one.u) for k, one in enumerate(self.chosen) if one.u)

    @cached_property
    def axes(self) -> tuple[Floats, Floats]:
        """Variances of each point along the axes of its covariance, (m, 3), and these axes as rows, (m, 3, 3)."""
        covariance = self.measurements.points.covariance_mm2
        if covariance is None:
            count = len(self.measurements.points.pose)
            return np.ones((count, 3)), np.tile(np.eye(3), (count, 1, 1))
        variances, vectors = np.linalg.eigh(covariance)
        return variances, vectors.transpose(0, 2, 1)

    @cached_property
    def _held_values(self) -> Floats:
        return np.array([value for _, value in self.held])

    def _seen(self, values: Floats, commands: Commands | None = None) -> "_Seen":
        geometry, poses = self.geometry(values), self.measurements.commands if commands is None else commands
        return _Seen(geometry, poses, geometry.frames(poses), len(self.chosen))

    def _moved(self, seen: "_Seen", pose: Ints, target: Ints) -> tuple[Floats, Floats]:
        """Return how targets move with the parameters, shape (m, 3, p), and where they are, shape (m, 3)."""
        flange = seen.frames[-1][pose]
        places = seen.geometry.places_mm(flange, target)
        moved = seen.motions.some(pose).of_points(places)
        for k, parameter in enumerate(self.chosen):
            match parameter.role:
                case TargetPlace(number, "x_mm" | "y_mm" | "z_mm" as part):
                    moved[target == number, :, k] = flange[target == number, :3, "xyz".index(part[0])]
        return moved, places

    def _turned(self, geometry: Geometry, flange: Floats) -> Floats:
        """Return how far orientations are turned from what was measured, mm at the lever, shape (m, 3)."""
        rows = self.measurements.orientations
        if not len(rows.pose):
            return np.zeros((0, 3))
        predicted = flange[rows.pose, :3, :3] @ geometry.tools[rows.target, :3, :3]
        apart = rotation_vectors_deg(predicted @ rows.rotation.transpose(0, 2, 1))
        return np.asarray(apart * (_RAD * LEVER_MM))

    def _add_tool_turns(self, rotated: Floats, seen: "_Seen", values: Floats) -> None:
        """Add what the angles of the targets' frames do to orientations of shape (m, 3, p)."""
        rows = self.measurements.orientations
        for k, parameter in enumerate(self.chosen):
            match parameter.role:
                case TargetPlace(number, "rx_deg" | "ry_deg" | "rz_deg" as part):
                    concerned = rows.target == number
                    axis = turning_axis(self._target_angles(values, number), part)
                    turned = seen.frames[-1][rows.pose[concerned], :3, :3] @ axis
                    rotated[concerned, :, k] = _RAD * LEVER_MM * turned

    def _target_angles(self, values: Floats, number: int) -> Floats:
        angles = np.zeros(3)
        for parameter, value in zip(self.chosen, values.tolist(), strict=True):
            match parameter.role:
                case TargetPlace(target, "rx_deg" | "ry_deg" | "rz_deg" as part) if target == number:
                    angles[FRAME_PARTS.index(part) - 3] = value
        return angles

    def _distance_rows(self, seen: "_Seen", values: Floats) -> Floats:
        rows = self.measurements.distances
        moved, places = self._moved(seen, rows.pose, rows.target)
        towards = places - self.anchors(values)[rows.anchor]
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        found = np.einsum("ni,nip->np", towards, moved)
        for k, parameter in enumerate(self.chosen):
            match parameter.role:
                case AnchorPlace(number, part):
                    found[:, k] = -towards[:, "xyz".index(part[0])] * (rows.anchor == number)
                case DeadPath(number):
                    found[:, k] = -1.0 * (rows.segment == number)
        return np.asarray(found)

    def anchors(self, values: Floats) -> Floats:
        """Return the places of the anchors at values of shape (p,), mm, shape (anchors, 3)."""
        places = np.array([one.place_mm for one in self.measurements.distances.anchors])
        for parameter, value in self._all(values):
            match parameter.role:
                case AnchorPlace(number, part):
                    places[number, "xyz".index(part[0])] = value
        return places

    def _dead_paths(self, values: Floats) -> Floats:
        """Return the dead paths at values of shape (p,), and at the end the zero of absolute distances, mm."""
        found = np.zeros(len(self.measurements.distances.segments) + 1)
        for parameter, value in self._all(values):
            match parameter.role:
                case DeadPath(number):
                    found[number] = value
        return found

    def _all(self, values: Floats) -> Sequence[tuple[Parameter, float]]:
        return [*zip(self.chosen, values.tolist(), strict=True), *self.held]


@dataclass(frozen=True)
class _Seen:
    """An arm at the poses.

    Attributes:
        frames: base and joints, shape (joints + 1, n, 4, 4).
        estimated: how many of the parameters are.
    """

    geometry: Geometry
    commands: Commands
    frames: Floats
    estimated: int

    @cached_property
    def motions(self) -> Motions:
        """What the estimated parameters do."""
        return self.geometry.motions(self.commands, self.frames, self.estimated)


def _keys(kind: int, *told_apart: Ints) -> Ints:
    """Return what tells groups apart: kind, then up to four numbers of shape (m,), and zeros, shape (m, 5)."""
    found = np.zeros((len(told_apart[0]), 5), dtype=np.int64)
    found[:, 0] = kind
    found[:, 1 : 1 + len(told_apart)] = np.column_stack(told_apart)
    return found
