"""Repeated passes of a measured path as poses that were attained several times (ISO 9283)."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.scara.validation import ModelOnPath, PathMeasurement
from catseye.calibration.core.types import Floats
from catseye.calibration.standards.iso9283 import PoseQuantities, pose

_SAME_RAD = 1e-7
"""Commands that differ by less are one and the same pose."""


@dataclass(frozen=True)
class RepeatedPoses:
    """Poses that were attained twice or more, from the same directions of approach.

    Attributes:
        rows: first row of each pose.
        poses: their quantities, mm, against the command.
        model_mm: distance of each barycentre from where the model puts it, NaN where it says nothing.
    """

    rows: tuple[int, ...]
    poses: tuple[PoseQuantities, ...]
    model_mm: Floats


def repeated_poses(path: PathMeasurement, model: ModelOnPath) -> RepeatedPoses:
    """Return the poses of a path that were attained twice or more.

    Accuracy is judged in the frame that the measurement has after its alignment with the model; repeatability does
    not depend on a frame.

    Args:
        model: aligned with the measurement.
    """
    commands = path.commands
    key = np.column_stack(
        [
            np.round(commands.theta1_rad / _SAME_RAD),
            np.round(commands.theta2_rad / _SAME_RAD),
            commands.direction1,
            commands.direction2,
        ]
    )
    # The arm has to have left a pose to attain it again.
    arrived = np.append(True, np.any(np.diff(key, axis=0) != 0.0, axis=1))
    group = np.unique(key, axis=0, return_inverse=True)[1]
    members = [np.flatnonzero((group == i) & arrived) for i in range(int(group.max()) + 1)]
    repeated = sorted((member for member in members if member.size > 1), key=lambda one: int(one[0]))
    poses = tuple(pose(model.comparison.aligned_mm[one], path.command_mm[one[0]]) for one in repeated)
    off = [
        float(np.hypot(*(found.barycentre - model.prediction.position_mm[one[0]])))
        for found, one in zip(poses, repeated, strict=True)
    ]
    return RepeatedPoses(tuple(int(one[0]) for one in repeated), poses, np.array(off))
