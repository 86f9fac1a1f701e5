"""What all other poses predict of a pose: how good a model is on what it has not seen, and which poses are wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from catseye.calibration.core.cross_validation import Fold, Folds, cross_validation, predicted_residuals
from catseye.calibration.core.errors import RejectionError
from catseye.calibration.core.projection import Projection, project
from catseye.calibration.core.significance import SIGNIFICANCE, adjusted
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.identification import Calibration, ModelName, identify_arm
from catseye.calibration.serial_arm.measurements import Measurements

_DIRECTIONS = 2
"""Degrees of freedom of what an arm misses a pose by: errors of a few joints move it along few directions."""

MOST_REJECTED = 0.2
"""Share of wrong poses beyond which the model is in doubt, not the measurement."""


@dataclass(frozen=True)
class HeldOut:
    """Errors of what the other poses predict.

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


def held_out(calibration: Calibration) -> HeldOut:
    """Leave out each pose in turn; no fit is repeated."""
    model, projection = calibration.model, _projection(calibration)
    predicted = predicted_residuals(projection, _folds(calibration))
    rows = model.measurements.points
    size, first = len(rows.pose), 3 * (len(rows.pose) + len(model.measurements.orientations.pose))
    along = np.linalg.norm(predicted[: 3 * size].reshape(-1, 3), axis=1)
    distances = model.measurements.distances.pose
    apart = np.abs(predicted[first : first + len(distances)])
    return HeldOut(np.concatenate([along, apart]), np.concatenate([rows.pose, distances]))


def without_wrong_poses(
    arm: SerialArm, measurements: Measurements, name: ModelName
) -> tuple[Calibration, tuple[RejectedPose, ...]]:
    """Identify, and leave out poses that contradict all others: the worst one, again and again.

    Raises:
        RejectionError: more than a fifth of the poses would have to go.
    """
    kept = np.ones(len(measurements.commands), dtype=np.bool_)
    seen = np.unique(measurements.poses).size
    rejected: list[RejectedPose] = []
    while True:
        found = identify_arm(arm, measurements.at(kept), name)
        worst = _worst(found)
        if worst is None:
            return found, tuple(rejected)
        rejected.append(worst)
        kept[worst.pose] = False
        if len(rejected) > MOST_REJECTED * seen:
            raise RejectionError(
                f"more than {100.0 * MOST_REJECTED:.0f} % of the poses contradict the model {name}: do not leave "
                "them out, look for what moved (base, tracker, tool), for joints in another order, or take a richer "
                "model"
            )


def wrong_flags(rejected: tuple[RejectedPose, ...], poses: int) -> Bools:
    """Return flags of the poses that were not rejected, shape (poses,)."""
    kept = np.ones(poses, dtype=np.bool_)
    kept[[one.pose for one in rejected]] = False
    return kept


def _worst(calibration: Calibration) -> RejectedPose | None:
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
    touched = model.jacobian(calibration.estimate.values) != 0.0
    own = np.zeros(len(numbers), dtype=np.int64)
    for column in touched.T:
        alone = np.unique(group[column])
        if len(alone) == 1 and alone[0] >= 0:
            own[alone[0]] += 1
    return Folds("one pose", names, np.asarray(group), own)
