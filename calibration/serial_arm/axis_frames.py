"""Base and flange of an arm from two of its axes, each shown by a joint that turned by itself.

Six-axis paper, section 3: the base from axes 1 and 2, the flange from axes 5 and 6, by the nominal parameters between
them.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.chain import Chain

_PARALLEL = 0.02
"""Sine of the angle between two axes below which they say nothing of the turn about them."""


@dataclass(frozen=True)
class AxisLine:
    """An axis as a line.

    Attributes:
        point_mm: on it, shape (3,).
        direction: unit vector, about which positive commands turn, shape (3,).
    """

    point_mm: Floats
    direction: Floats


def nominal_axis(chain: Chain, joint: int, pose: Floats) -> AxisLine:
    """Return the axis of a joint in the frame of the base.

    Args:
        joint: its number, from 1.
        pose: joints, deg or mm, shape (joints,).
    """
    frame = chain.frames(pose[None])[joint, 0]
    return AxisLine(frame[:3, 3], frame[:3, 2] * chain.joints[joint - 1].sign)


def frame_of_axes(nominal: tuple[AxisLine, AxisLine], seen: tuple[AxisLine, AxisLine]) -> Floats:
    """Return the motion that brings two nominal axes onto those that an instrument has seen.

    The first axis is met exactly, with the point of it that is nearest to the second; the second in its direction
    about the first.

    Returns:
        Base in the frame of the instrument, shape (4, 4).

    Raises:
        UnidentifiableError: the axes are parallel.
    """
    found = np.eye(4)
    found[:3, :3] = _triad(*seen) @ _triad(*nominal).T
    found[:3, 3] = _foot(*seen) - found[:3, :3] @ _foot(*nominal)
    return found


def _triad(first: AxisLine, second: AxisLine) -> Floats:
    across = np.cross(first.direction, second.direction)
    size = float(np.linalg.norm(across))
    if size < _PARALLEL:
        raise UnidentifiableError(
            "the two axes are parallel: they do not say how the frame is turned about them; choose axes that cross",
            [],
        )
    across = across / size
    return np.column_stack([first.direction, across, np.cross(first.direction, across)])


def _foot(first: AxisLine, second: AxisLine) -> Floats:
    """Return the point of the first line that is nearest to the second."""
    between = second.point_mm - first.point_mm
    cosine = float(first.direction @ second.direction)
    along = (between @ first.direction - cosine * (between @ second.direction)) / (1.0 - cosine**2)
    return np.asarray(first.point_mm + along * first.direction)
