"""What all other poses predict of a pose: how good a model is on what it has not seen, and which poses are wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from catseye.calibration.core.cross_validation import Fold, Folds, cross_validation, predicted_residuals
from catseye.calibration.core.projection import Projection, project
from catseye.calibration.core.significance import SIGNIFICANCE, adjusted
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.model import ArmModel

_DIRECTIONS = 2
"""Degrees of freedom of what an arm misses a pose by: errors of a few joints move it along few directions."""


@dataclass(frozen=True)
class HeldOut:
    """Errors of what calibrations without a pose predict of it.

    Attributes:
        error_mm: 3-D error of each point, error of each distance; NaN where the others do not say it, shape (m,).
        pose: number of the pose of each, shape (m,).
    """

    error_mm: Floats
    pose: Ints

    @property
    def mean_mm(self) -> float:
        """Mean error."""
        return float(np.nanmean(self.error_mm))

    @property
    def max_mm(self) -> float:
        """Largest error."""
        return float(np.nanmax(self.error_mm))


@dataclass(frozen=True)
class RejectedPose:
    """A pose that contradicts the others.

    Attributes:
        pose: its number.
        name: its name.
        error_mm: rms by which the others miss it.
        probability: of so much, when nothing is wrong with it, corrected for the number of poses.
    """

    pose: int
    name: str
    error_mm: float
    probability: float


def predicted_errors_mm(model: ArmModel, values: Floats, left_out: Bools) -> Floats:
    """Return by how much the other poses, and the errors that rows share, miss each point and each distance.

    No fit is repeated: this is linear about the values, and exact where they are those of the others alone.

    Args:
        values: of the parameters, shape (p,).
        left_out: flags of the poses, shape (n,).

    Returns:
        3-D errors of points, then errors of distances, shape (m,); NaN of poses that are not left out, and where the
        others do not determine them.
    """
    of_row = np.where(model.pose_of_row >= 0, left_out[model.pose_of_row], False)
    folds = _folds_of(model, values, np.where(of_row, 0, -1), ("left out",))
    settled = project(model, values, model.residuals(values)).settled
    predicted = predicted_residuals(settled, folds)
    rows = model.measurements
    size, first = len(rows.points.pose), 3 * (len(rows.points.pose) + len(rows.orientations.pose))
    along = np.linalg.norm(predicted[: 3 * size].reshape(-1, 3), axis=1)
    apart = np.abs(predicted[first : first + len(rows.distances.pose)])
    errors = np.concatenate([along, apart])
    errors[_known_nowhere_else(model, left_out)] = np.nan
    return errors


def effective_parameters(calibration: Calibration) -> float:
    """Return how many parameters the rows pay for: the trace of the hat matrix over what was measured.

    What is known beforehand of a parameter pays for a part of it, so that maps cost less than their parameters.
    """
    measured = _projection(calibration).orthonormal[: calibration.model.measured_rows]
    return float(np.sum(measured**2))


def most_contradicting(calibration: Calibration) -> RejectedPose | None:
    """Return the pose that the others miss most, where chance does not explain it."""
    judged = cross_validation(_projection(calibration), _folds(calibration)).folds
    numbers = np.unique(calibration.model.measurements.poses)
    beside = _among_poses(judged)
    failing = [
        (max(fold.probability, among), -fold.predicted_um, k)
        for k, (fold, among) in enumerate(zip(judged, beside, strict=True))
        if fold.fails and among < SIGNIFICANCE
    ]
    if not failing:
        return None
    probability, _, k = min(failing)
    fold: Fold = judged[k]
    return RejectedPose(int(numbers[k]), fold.name, 1e-3 * fold.predicted_um, probability)


def _among_poses(folds: Sequence[Fold]) -> list[float]:
    """Return how likely each pose is among the others, whose scatter the median shows, corrected for their number.

    What an arm misses a pose by, all targets of the pose have in common: their rows are no independent witnesses.
    Wrong poses hardly move the median.
    """
    sizes = np.array(
        [(fold.predicted_um / fold.expected_um) ** 2 if _told(fold) else np.nan for fold in folds]
    )
    known = np.isfinite(sizes)
    typical = float(np.median(sizes[known])) if known.any() else 0.0
    if typical <= 0.0:
        return [fold.probability for fold in folds]
    dof = np.array([min(fold.rows, _DIRECTIONS) for fold in folds])
    single = np.asarray(stats.chi2.sf(sizes / typical * stats.chi2.median(dof), dof))
    return [
        adjusted(float(one), int(known.sum())) if ok else 1.0 for one, ok in zip(single, known, strict=True)
    ]


def _told(fold: Fold) -> bool:
    return fold.identified and fold.expected_um > 0.0


def _projection(calibration: Calibration) -> Projection:
    found = calibration.estimate
    return project(calibration.model, found.values, found.residuals_mm)


def _folds(calibration: Calibration) -> Folds:
    """Return one fold a pose."""
    model = calibration.model
    numbers = np.unique(model.measurements.poses)
    names = tuple(model.measurements.names[k] for k in numbers)
    group = np.where(model.pose_of_row < 0, -1, np.searchsorted(numbers, model.pose_of_row))
    return _folds_of(model, calibration.estimate.values, np.asarray(group), names)


def _folds_of(model: ArmModel, values: Floats, group: Ints, names: tuple[str, ...]) -> Folds:
    """Return folds of rows with what each alone says of parameters; −1 of rows that are in none."""
    touched = model.jacobian(values) != 0.0
    own = np.zeros(len(names), dtype=np.int64)
    for column in touched.T:
        alone = np.unique(group[column])
        if len(alone) == 1 and alone[0] >= 0:
            own[alone[0]] += 1
    return Folds("one pose", names, group, own)


def _known_nowhere_else(model: ArmModel, left_out: Bools) -> Bools:
    """Return flags of points and distances whose target, anchor or segment no other pose says anything of."""
    points, distances = model.measurements.points, model.measurements.distances
    targets = np.concatenate([points.target, distances.target])
    out = left_out[np.concatenate([points.pose, distances.pose])]
    unsure = [k for k, one in enumerate(model.arm.targets) if one.u_mm != 0.0]
    found = np.isin(targets, np.setdiff1d(unsure, targets[~out]))
    apart, there = out[len(points.pose) :], ~out[len(points.pose) :]
    loose = [k for k, one in enumerate(distances.anchors) if one.u_mm != 0.0]
    lost = np.isin(distances.anchor, np.setdiff1d(loose, distances.anchor[there]))
    lost |= (distances.segment >= 0) & ~np.isin(distances.segment, distances.segment[there])
    found[len(points.pose) :] |= lost & apart
    return np.asarray(found)
