"""Repeated passes of a measured path as poses that were attained several times (ISO 9283)."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.model import Block, Column, Paragraph, Table
from catseye.app.results.numbers import COUNT, PLAIN, fixed, number
from catseye.app.results.scara.validation import ModelOnPath, PathMeasurement, PathValidation
from catseye.calibration.core.types import Floats
from catseye.calibration.standards.iso9283 import PoseQuantities, pose

_SAME_RAD = 1e-7
"""Commands that differ by less are one and the same pose."""

_MOST = 40
"""Poses that a table lists."""

_UM = fixed(1)
_COLUMNS = (
    Column("pose", "pose: X, Y", "mm"),
    Column("n", "n", format=COUNT),
    Column("ap_um", "AP", "µm", _UM),
    Column("rp_um", "RP", "µm", _UM),
    Column("ap_to_model_um", "AP to the model", "µm", _UM),
)


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


def repeat_blocks(validation: PathValidation) -> list[Block]:
    """Return accuracy and repeatability of repeated poses; nothing when none was attained twice."""
    path, model = validation.path, validation.models[-1]
    found = repeated_poses(path, model)
    if not found.rows:
        return []
    rows = [
        (
            ", ".join(number(round(float(value), 3), PLAIN) for value in path.command_mm[row]),
            pose.n,
            1e3 * pose.accuracy,
            1e3 * pose.repeatability,
            1e3 * float(off),
        )
        for row, pose, off in zip(found.rows, found.poses, found.model_mm, strict=True)
    ]
    rp_um = [1e3 * pose.repeatability for pose in found.poses]
    counts = sorted({pose.n for pose in found.poses})
    text = (
        f"{len(rows)} poses were attained {counts[0]}{f' to {counts[-1]}' if len(counts) > 1 else ''} times (the "
        f"standard test has 30 cycles); RP {np.median(rp_um):.1f} µm in the median, {max(rp_um):.1f} µm at most. AP: "
        "pose accuracy, in the frame aligned to the last model; RP: pose repeatability, which holds the instrument's "
        "scatter too."
    )
    more = f" The first {_MOST} are listed." if len(rows) > _MOST else ""
    table = Table("repeated_poses", "Repeated poses, quantities of ISO 9283", _COLUMNS, tuple(rows[:_MOST]))
    return [table, Paragraph(text + more)]
