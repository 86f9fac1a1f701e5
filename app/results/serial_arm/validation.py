"""A calibrated serial arm against measurements that it has not seen: places of targets, or lengths of a ballbar."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.errors import UsageError
from catseye.app.results.model import Statement
from catseye.app.results.numbers import counted
from catseye.app.results.serial_arm.anchors import read_anchors
from catseye.app.results.serial_arm.frame_noise import with_frame_noise
from catseye.app.results.serial_arm.identified_arm import (
    IdentifiedArm,
    arm_with_frames,
    ends_with_frames,
    identified_arm,
)
from catseye.app.results.serial_arm.length_errors import length_errors
from catseye.app.results.serial_arm.length_variance import length_variance_mm2, targets_of_distances
from catseye.app.results.serial_arm.measured_poses import MeasuredPoses, read_measured_poses
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.app.results.serial_arm.row_scatter import row_scatter_mm, states_compared, stating
from catseye.app.results.serial_arm.validation_gate import (
    require_same_dead_paths,
    require_same_frame,
    require_table_of_arm,
)
from catseye.app.results.serial_arm.validation_text import validation_statements
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.serial_arm.arm import Anchor
from catseye.calibration.serial_arm.geometry import Commands, Geometry
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.read_back import read_back_mistake

_CHI2_95_OF_3 = 7.814727903251179
"""0.95 quantile of χ² with three degrees of freedom."""

_CHI2_95_OF_1 = 3.841458820694124


@dataclass(frozen=True)
class Errors:
    """Errors of one state of the arm, predicted minus measured.

    Attributes:
        signed_mm: lengths of three-dimensional errors, or errors of distances with their sign, mm, shape (n,).
    """

    signed_mm: Floats

    @property
    def error_mm(self) -> Floats:
        """Sizes, shape (n,)."""
        return np.abs(self.signed_mm)

    def figures(self) -> dict[str, float]:
        """Return mean, standard deviation and maximum of the sizes, by the names of the JSON output."""
        return _figures(self.error_mm)

    def of(self, rows: Bools) -> dict[str, float]:
        """Return the same of some rows, the mean with its sign, as ballbar tables have it."""
        chosen = self.signed_mm[rows]
        return {**_figures(chosen), "max_mm": float(np.abs(chosen).max())}


@dataclass(frozen=True)
class ArmValidation:
    """How a calibration does on measurements that it has not seen.

    Attributes:
        frames_only: the links as drawn, with base and targets of the result; None where the result has none.
        inside_95_percent: share of errors within the 95 % region of predictions and rows, in percent;
            None where nobody says how uncertain the rows are.
        poses: name of each row's pose.
        targets: name of each row's target.
        of_distances: lengths were measured, not places.
        fitted: anchors of distances that nobody knew: each state of the arm has its own best place for them.
        dead_paths: that nobody knew, of known anchors; likewise.
        assumed_u_mm: standard uncertainty of a coordinate, or of a length, that is taken for rows which state
            none: what those of the calibration scatter by. None where they state theirs, or nothing says it.
    """

    calibrated: Errors
    frames_only: Errors | None
    inside_95_percent: float | None
    poses: tuple[str, ...]
    targets: tuple[str, ...]
    of_distances: bool
    fitted: tuple[str, ...] = ()
    dead_paths: tuple[str, ...] = ()
    assumed_u_mm: float | None = None

    @property
    def states(self) -> list[tuple[str, Errors]]:
        """What is compared, by name."""
        states = (("links as drawn, frames fitted", self.frames_only), ("calibrated", self.calibrated))
        return [(name, errors) for name, errors in states if errors is not None]

    def by_target(self) -> list[tuple[str, str, dict[str, float]]]:
        """Return target, state and figures, the mean with its sign."""
        names = np.array(self.targets)
        return [
            (target, state, errors.of(names == target))
            for target in dict.fromkeys(self.targets)
            for state, errors in self.states
        ]

    def statements(self) -> list[Statement]:
        """Return what is said of it."""
        return validation_statements(
            counted(len(self.targets), "measured length" if self.of_distances else "measured target"),
            None if self.frames_only is None else self.frames_only.figures(),
            self.calibrated.figures(),
            self.inside_95_percent,
            self.fitted,
            self.dead_paths,
            self.assumed_u_mm,
        )


def validate_arm(
    result: SerialArmResult, measured: Path, anchors: Path | None = None, frame: Floats | None = None
) -> ArmValidation:
    """Compare a result with a table of measured poses, or of distances.

    Args:
        anchors: of distances; those of the result without it. One that nobody knows is fitted, and so is a dead path.
        frame: covariance of the world frame of the table by the noise of its nests, shape (6, 6); None without one.

    Raises:
        UsageError: the table is missing or wrong, or lacks the joints that the result was identified with; names file
            and line.
        InsufficientPointsError: too few distances to an anchor, or with a dead path, that has to be fitted.
        ImplausibleError: the table cannot be of this arm; the likely mistake is named.
    """
    if frame is not None:
        result = with_frame_noise(result, frame)
    arm, frames = identified_arm(result), arm_with_frames(result)
    stated = {} if anchors is None else read_anchors(anchors)
    known = {name: Anchor(name, _point(place)) for name, place in arm.distances.anchors.items()} | stated
    description = result.description or arm_description(result.arm)
    rows = _with_joints(result, read_measured_poses([measured], description, arm.arm, known))
    require_table_of_arm(arm, rows)
    ends = _Ends(stated, *ends_with_frames(result))
    if states_compared(rows):
        return _compared(arm, frames, rows, ends)
    assumed = row_scatter_mm(result, of_distances=not len(rows.points.pose))
    if assumed is None:
        return replace(_compared(arm, frames, rows, ends), inside_95_percent=None)
    return replace(_compared(arm, frames, stating(rows, assumed), ends), assumed_u_mm=assumed)


def _compared(
    arm: IdentifiedArm, frames: Geometry | None, rows: Measurements, ends: "_Ends"
) -> ArmValidation:
    return _places(arm, frames, rows) if len(rows.points.pose) else _distances(arm, frames, rows, ends)


def _point(place: Floats) -> tuple[float, float, float]:
    x, y, z = place.tolist()
    return x, y, z


def _with_joints(result: SerialArmResult, tables: MeasuredPoses) -> Measurements:
    """Return the measurements with the joints that the result was identified with.

    Raises:
        UsageError: they were read back, and the tables have none, or others than those of the poses.
    """
    rows = tables.measurements
    if result.joints == "commanded":
        return rows
    if tables.read_back is None:
        raise UsageError(
            "the result was identified with the joints that the controller read back: the table needs them, too "
            "(q1_read_deg …)"
        )
    if text := read_back_mistake(tables.arm, rows.commands.joints, tables.read_back, rows.names):
        raise UsageError(text)
    sides = rows.commands.approach
    commands = Commands.of(tables.arm, tables.read_back, sides)
    return Measurements(commands, rows.names, rows.points, rows.orientations, rows.distances)


def _places(arm: IdentifiedArm, frames: Geometry | None, rows: Measurements) -> ArmValidation:
    points, commands = rows.points, rows.commands
    missed, bare, square = (
        np.zeros((len(points.pose), 3)),
        np.zeros(len(points.pose)),
        np.zeros(len(points.pose)),
    )
    for number in np.unique(points.target).tolist():
        of_it = np.flatnonzero(points.target == number)
        there = commands.some(points.pose[of_it])
        places, covariance = arm.places_mm(there, number)
        if points.covariance_mm2 is not None:
            covariance = covariance + points.covariance_mm2[of_it]
        missed[of_it] = places - points.place_mm[of_it]
        square[of_it] = np.einsum(
            "ni,ni->n", missed[of_it], np.linalg.solve(covariance, missed[of_it][:, :, None])[:, :, 0]
        )
        if frames is not None:
            drawn = frames.places_mm(frames.frames(there)[-1], np.full(len(of_it), number))
            bare[of_it] = np.linalg.norm(drawn - points.place_mm[of_it], axis=1)
    require_same_frame(arm, missed)
    return ArmValidation(
        Errors(np.asarray(np.linalg.norm(missed, axis=1))),
        None if frames is None else Errors(bare),
        100.0 * float(np.mean(square <= _CHI2_95_OF_3)),
        tuple(rows.names[k] for k in points.pose),
        tuple(arm.arm.targets[k].name for k in points.target),
        of_distances=False,
    )


@dataclass(frozen=True)
class _Ends:
    """What is known of the ends of distances beside the calibrated arm.

    Attributes:
        stated: anchors of a file; one without a place is not known.
        drawn: places of anchors, mm, as they were fitted with the links as drawn.
        drawn_paths: dead paths, mm, likewise.
    """

    stated: Mapping[str, Anchor]
    drawn: Mapping[str, Floats]
    drawn_paths: Mapping[str, float]

    def known(self, fitted: Mapping[str, Floats]) -> dict[str, Floats]:
        """Return the places of anchors, mm: stated ones, else those that were fitted with a state of the arm."""
        stated = {name: np.array(one.place_mm) for name, one in self.stated.items() if one.u_mm is not None}
        return {name: place for name, place in fitted.items() if name not in self.stated} | stated


def _distances(arm: IdentifiedArm, frames: Geometry | None, rows: Measurements, ends: _Ends) -> ArmValidation:
    distances = rows.distances
    places, moved = targets_of_distances(rows, lambda at, target: arm.moved_mm(at, target))
    found = length_errors(ends.known(arm.distances.anchors), arm.distances.dead_paths, places, rows)
    require_same_dead_paths(arm, found, rows)
    variance = length_variance_mm2(arm, moved, found, rows, ends.stated)
    drawn = None
    if frames is not None:
        of_frames = frames
        seen, _ = targets_of_distances(
            rows,
            lambda at, target: (
                of_frames.places_mm(of_frames.frames(at)[-1], np.full(len(at), target)),
                np.zeros((len(at), 3, 0)),
            ),
        )
        drawn = Errors(length_errors(ends.known(ends.drawn), ends.drawn_paths, seen, rows).missed_mm)
    return ArmValidation(
        Errors(found.missed_mm),
        drawn,
        100.0 * float(np.mean(found.missed_mm**2 <= _CHI2_95_OF_1 * variance)),
        tuple(rows.names[k] for k in distances.pose),
        tuple(arm.arm.targets[k].name for k in distances.target),
        of_distances=True,
        fitted=tuple(one.name for one in distances.anchors if one.u_mm is None),
        dead_paths=found.dead_paths,
    )


def _figures(values: Floats) -> dict[str, float]:
    return {"mean_mm": float(values.mean()), "std_mm": float(values.std()), "max_mm": float(values.max())}
