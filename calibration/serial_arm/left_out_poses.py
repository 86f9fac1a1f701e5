"""Cross-validation of models: calibrations without a part of the poses, made anew from the beginning.

Nothing that the poses left out say reaches the calibration that is to predict them: basis, drift, scatter, size of
maps and wrong poses are found from the others alone. Poses at the same command are left out together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from catseye.calibration.core.errors import (
    CalibrationError,
    ConvergenceError,
    InsufficientPointsError,
    UnidentifiableError,
)
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.fitted import MOST_REJECTED, identified, with_shared, without_wrong_poses
from catseye.calibration.serial_arm.held_out import RejectedPose, predicted_errors_mm
from catseye.calibration.serial_arm.identification import Calibration, ModelName
from catseye.calibration.serial_arm.measurements import Measurements

FOLDS = 10
"""Parts of the poses that are left out in turn."""

NOT_IDENTIFIED = (InsufficientPointsError, UnidentifiableError, ConvergenceError)
"""What poses that do not carry a model lead to."""

_SEED = 1


@dataclass
class Predictions:
    """What calibrations without a pose predict of it.

    Attributes:
        errors_mm: of points, then of distances, by model; NaN where the others do not determine them, each (m,).
        reasons: why a model does not predict all poses.
    """

    errors_mm: dict[ModelName, Floats]
    reasons: dict[ModelName, str] = field(default_factory=dict)


def same_command(measurements: Measurements) -> Ints:
    """Return a number of each pose that those at the same command share, shape (n,)."""
    _, found = np.unique(measurements.commands.joints, axis=0, return_inverse=True)
    return np.asarray(found.ravel(), dtype=np.int64)


def parts_of(measurements: Measurements, command: Ints) -> list[Bools]:
    """Return flags of the poses of each part that is left out at a time, each of shape (n,).

    Args:
        command: number of each pose's command, shape (n,).

    Raises:
        InsufficientPointsError: there is one command only.
    """
    commands = np.unique(command[measurements.poses])
    if len(commands) < 2:
        raise InsufficientPointsError("all poses are at one command, and none shows how others are missed")
    count = min(FOLDS, len(commands))
    # Drawn, since an order may have a period: nests are measured in turn.
    part = np.full(int(command.max()) + 1, -1)
    part[np.random.default_rng(_SEED).permutation(commands)] = np.arange(len(commands)) % count
    return [part[command] == k for k in range(count)]


def predict_left_out(
    arm: SerialArm, measurements: Measurements, names: Sequence[ModelName], command: Ints
) -> Predictions:
    """Predict all poses by calibrations without them.

    Args:
        names: of models, the richest last.
        command: number of each pose's command, shape (n,).
    """
    rows = len(measurements.points.pose) + len(measurements.distances.pose)
    found = Predictions({name: np.full(rows, np.nan) for name in names})
    for left_out in parts_of(measurements, command):
        others = measurements.at(~left_out)
        richest, _ = richest_without_wrong(arm, others, names, 2.0 * MOST_REJECTED)
        others = richest.model.measurements
        used = left_out.copy()
        used[others.poses] = True
        for name in names:
            try:
                fit = with_shared(richest if name == richest.name else identified(arm, others, name))
            except NOT_IDENTIFIED as why:
                found.reasons.setdefault(name, str(why))
                continue
            model = fit.model_of(measurements.at(used))
            errors = predicted_errors_mm(model, fit.calibration.estimate.values, left_out)
            known = used[pose_of_errors(measurements)]
            found.errors_mm[name][np.flatnonzero(known)[np.isfinite(errors)]] = errors[np.isfinite(errors)]
    return found


def richest_without_wrong(
    arm: SerialArm, measurements: Measurements, names: Sequence[ModelName], most: float = MOST_REJECTED
) -> tuple[Calibration, tuple[RejectedPose, ...]]:
    """Identify the richest model that the measurements identify, and leave out poses that contradict it.

    Raises:
        RejectionError: more than a share of the poses would have to go.
        CalibrationError: no model is identified.
    """
    error: CalibrationError | None = None
    for name in reversed(names):
        try:
            return without_wrong_poses(arm, measurements, name, most)
        except NOT_IDENTIFIED as why:
            error = error or why
    raise error or InsufficientPointsError("there is no model to identify")


def by_command_mm(errors_mm: Floats, measurements: Measurements, command: Ints, scored: Bools) -> Floats:
    """Return the mean error at each command of poses that are scored, shape (k,).

    Args:
        errors_mm: of points, then of distances, shape (m,).
        scored: flags of these, shape (m,).
    """
    of_row = command[pose_of_errors(measurements)][scored]
    _, where, counts = np.unique(of_row, return_inverse=True, return_counts=True)
    return np.asarray(np.bincount(where, errors_mm[scored]) / counts)


def pose_of_errors(measurements: Measurements) -> Ints:
    """Return the number of the pose of each point, then of each distance, shape (m,)."""
    return np.concatenate([measurements.points.pose, measurements.distances.pose])
