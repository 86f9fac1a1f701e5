"""Circular tests after ISO 230-4: circular errors and radial errors of circles in both senses."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats

_FEWEST = 3
_STEPS = 20
"""Steps of the circle's fit; a start this near settles in a few."""


@dataclass(frozen=True)
class Circular:
    """Quantities of a circle that was driven in both senses, in the unit of the radii.

    Attributes:
        clockwise: circular error G of the clockwise contour, the range of its radii.
        counter_clockwise: G of the other sense.
        bidirectional: bidirectional circular error G(b), the range over both about the common centre.
        largest: F_max, largest radial error from the nominal circle.
        smallest: F_min, smallest one.
        mean: mean bidirectional radial error D.
    """

    clockwise: float
    counter_clockwise: float
    bidirectional: float
    largest: float
    smallest: float
    mean: float


def circular(clockwise: Floats, counter_clockwise: Floats) -> Circular:
    """Return the quantities from radial errors about one and the same centre.

    Args:
        clockwise: radius minus nominal radius along the clockwise contour, shape (n,).
        counter_clockwise: the same for the other sense, shape (k,).

    Raises:
        InsufficientPointsError: a contour has fewer than three points.
        ArgumentError: a radial error is not finite.
    """
    require_finite(clockwise, "clockwise")
    require_finite(counter_clockwise, "counter_clockwise")
    if min(clockwise.size, counter_clockwise.size) < _FEWEST:
        raise InsufficientPointsError(
            f"a circular error needs {_FEWEST} points or more of each sense; measure the circle both ways"
        )
    both = np.concatenate([clockwise, counter_clockwise])
    return Circular(
        clockwise=float(np.ptp(clockwise)),
        counter_clockwise=float(np.ptp(counter_clockwise)),
        bidirectional=float(np.ptp(both)),
        largest=float(both.max()),
        smallest=float(both.min()),
        mean=0.5 * float(clockwise.mean() + counter_clockwise.mean()),
    )


def algebraic_centre(xy: Floats) -> Floats:
    """Return the centre of a circle through positions that lie on one, shape (2,).

    Args:
        xy: positions, shape (n, 2); those that lie on no circle give a point without meaning.
    """
    mean = xy.mean(axis=0)
    own = xy - mean
    design = np.column_stack([2.0 * own, np.ones(len(own))])
    return np.asarray(mean + np.linalg.lstsq(design, np.sum(own**2, axis=1), rcond=None)[0][:2])


def least_squares_centre(xy: Floats) -> Floats:
    """Return the centre of the least-squares circle through measured positions, in their unit, shape (2,).

    Args:
        xy: positions near a circle, shape (n, 2).

    Raises:
        InsufficientPointsError: fewer than three positions.
        ArgumentError: they are not pairs of finite numbers.
    """
    require_shape(xy, (None, 2), "xy")
    require_finite(xy, "xy")
    if len(xy) < _FEWEST:
        raise InsufficientPointsError(f"{len(xy)} position(s) determine no circle: measure {_FEWEST} or more")
    centre = algebraic_centre(xy)
    for _ in range(_STEPS):
        arm = xy - centre
        length = np.hypot(*arm.T)
        jacobian = np.column_stack([-arm / length[:, None], -np.ones(length.size)])
        step = np.linalg.lstsq(jacobian, length.mean() - length, rcond=None)[0][:2]
        centre = centre + step
        if float(np.abs(step).max()) <= 1e-12 * float(length.mean()):
            break
    return np.asarray(centre, dtype=np.float64)
