"""Circular tests after ISO 230-4: circular errors and radial errors of circles in both senses."""

from dataclasses import dataclass

import numpy as np

from calibration.errors import InsufficientPointsError
from calibration.types import Floats

_FEWEST = 3


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
    """
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


def least_squares_centre(xy_mm: Floats, radius_mm: float, start_mm: Floats) -> Floats:
    """Return the centre of the least-squares circle through measured positions, mm, shape (2,).

    Args:
        xy_mm: positions, mm, shape (n, 2).
        radius_mm: rough radius, mm.
        start_mm: rough centre, mm, shape (2,).
    """
    parameters = np.array([*start_mm, radius_mm])
    for _ in range(20):
        arm = xy_mm - parameters[:2]
        length = np.hypot(*arm.T)
        jacobian = np.column_stack([-arm / length[:, None], -np.ones(length.size)])
        step = np.linalg.lstsq(jacobian, parameters[2] - length, rcond=None)[0]
        parameters = parameters + step
        if float(np.abs(step).max()) <= 1e-12 * radius_mm:
            break
    return np.asarray(parameters[:2], dtype=np.float64)
