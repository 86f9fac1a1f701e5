"""Points of a plane or a line through the workspace, all with the orientation of one pose."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, get_args

import numpy as np

from catseye.calibration.core.arguments import require_count, require_finite, require_one_of, require_shape
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.inverse import inverse_kinematics

AxisName = Literal["x", "y", "z"]

_MOST = 100_000
"""Points of a slice: the prediction takes some hundredths of a second for each."""


@dataclass(frozen=True)
class SliceAxis:
    """Points along an axis of the base.

    Attributes:
        low_mm: the first.
        high_mm: the last.
        count: how many.
    """

    low_mm: float
    high_mm: float
    count: int

    def __post_init__(self) -> None:
        require_finite([self.low_mm, self.high_mm], "ends of the slice")
        require_count(self.count, "points of the slice", 2)
        if not self.low_mm < self.high_mm:
            raise ArgumentError(
                f"a slice from {self.low_mm:g} to {self.high_mm:g} mm: state the smaller end first"
            )


@dataclass(frozen=True)
class SlicePoint:
    """A point of a slice.

    Attributes:
        tcp_mm: of the tool centre point in the base, shape (3,).
        joints: deg or mm, shape (joints,); None where the arm does not reach it.
        reason: why it does not.
    """

    tcp_mm: Floats
    joints: Floats | None
    reason: str = ""


def slice_points(
    chain: Chain, pose: Floats, axes: Mapping[AxisName, SliceAxis], tool: Floats | None = None
) -> Sequence[SlicePoint]:
    """Return the points of a slice; what the axes leave open is as at the pose, orientation and solution too.

    Args:
        chain: the arm.
        pose: joints, deg or mm, shape (joints,).
        axes: one to three of them.
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.

    Raises:
        ArgumentError: the slice has more than 100 000 points.
    """
    count = math.prod(axis.count for axis in axes.values())
    if count > _MOST:
        raise ArgumentError(f"the slice has {count} points, {_MOST} at most can be predicted: state fewer")
    require_shape(pose, (len(chain.joints),), "pose")
    for name in axes:
        require_one_of(AxisName, name, "axis of the slice")
    tip = chain.flange(pose[None])[0] @ (np.eye(4) if tool is None else tool)
    lines = [
        np.linspace(axis.low_mm, axis.high_mm, axis.count) if (axis := axes.get(name)) else [float(tip[k, 3])]
        for k, name in enumerate(get_args(AxisName))
    ]
    places = np.array(list(product(*lines)))
    targets = np.repeat(tip[None], len(places), axis=0)
    targets[:, :3, 3] = places
    solved = inverse_kinematics(chain, targets, pose, tool)
    reasons = {one.row: one.reason for one in solved.refused}
    return [
        SlicePoint(place, None if row in reasons else joints, reasons.get(row, ""))
        for row, (place, joints) in enumerate(zip(places, solved.poses, strict=True))
    ]
