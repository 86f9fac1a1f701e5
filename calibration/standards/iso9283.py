"""Performance of robots after ISO 9283: pose and distance accuracy and repeatability.

Values come in the unit of the positions.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class PoseQuantities:
    """One pose that was attained n times.

    Attributes:
        n: how often; the standard test has 30 cycles.
        barycentre: mean attained position, shape (k,).
        accuracy: pose accuracy AP, distance of the barycentre from the command.
        accuracy_of_axes: barycentre minus command, shape (k,).
        repeatability: pose repeatability RP, mean distance from the barycentre plus three standard deviations of it.
    """

    n: int
    barycentre: Floats
    accuracy: float
    accuracy_of_axes: Floats
    repeatability: float


def pose(attained: Floats, command: Floats) -> PoseQuantities:
    """Return the quantities of a pose.

    Args:
        attained: positions, shape (n, k) with k = 2 or 3, n >= 2.
        command: commanded position, shape (k,).

    Raises:
        InsufficientPointsError: fewer than two attained positions.
        ArgumentError: the command has other coordinates than the positions, or a number is not finite.
    """
    require_shape(attained, (None, np.size(command)), "attained")
    require_finite(attained, "attained")
    require_finite(command, "command")
    barycentre = attained.mean(axis=0)
    off = barycentre - command
    return PoseQuantities(
        len(attained), barycentre, float(np.linalg.norm(off)), off, pose_repeatability(attained)
    )


def pose_repeatability(attained: Floats) -> float:
    """Return RP = l̄ + 3 S_l, l the distances from the barycentre.

    Args:
        attained: positions, shape (n, 2) or (n, 3), n >= 2.

    Raises:
        InsufficientPointsError: fewer than two attained positions.
    """
    _require_two(len(attained))
    distance = np.linalg.norm(attained - attained.mean(axis=0), axis=1)
    return float(distance.mean() + 3.0 * distance.std(ddof=1))


@dataclass(frozen=True)
class DistanceQuantities:
    """A distance that was attained n times.

    Attributes:
        n: how often.
        accuracy: distance accuracy AD, mean attained minus commanded distance.
        repeatability: distance repeatability RD, half width ±3 S.
    """

    n: int
    accuracy: float
    repeatability: float


def distance(attained: Floats, command: float) -> DistanceQuantities:
    """Return the quantities of a distance.

    Args:
        attained: distances, shape (n,), n >= 2.
        command: commanded distance.

    Raises:
        InsufficientPointsError: fewer than two attained distances.
        ArgumentError: a distance is not finite.
    """
    require_finite(attained, "attained")
    require_finite(command, "command")
    _require_two(attained.size)
    spread = distance_repeatability(float(attained.std(ddof=1)))
    return DistanceQuantities(attained.size, float(attained.mean()) - command, spread)


def distance_repeatability(s: float) -> float:
    """Return RD, the half width ±3 S that belongs to a standard deviation of distances."""
    return 3.0 * s


def _require_two(count: int) -> None:
    if count < 2:
        raise InsufficientPointsError(
            f"{count} attained value(s) have no spread: repeat the pose; the standard test has 30 cycles"
        )
