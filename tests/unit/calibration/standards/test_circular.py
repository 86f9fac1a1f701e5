"""Circular errors against deviations placed by hand."""

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.standards.circular import circular, least_squares_centre


def test_deviations_placed_by_hand() -> None:
    found = circular(np.array([1.0, 2.0, 3.0, -1.0]), np.array([0.0, 4.0, -2.0, 1.0]))
    assert (found.clockwise, found.counter_clockwise, found.bidirectional) == (4.0, 6.0, 6.0)
    assert (found.largest, found.smallest, found.mean) == (4.0, -2.0, 1.0)


def test_the_centre_is_fitted() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    # Harmonics from the second on move neither centre nor radius of the least-squares circle but by second order.
    radius = 100.0 + 0.01 * np.cos(3.0 * angle)
    xy = np.column_stack([30.2 + radius * np.cos(angle), -7.3 + radius * np.sin(angle)])
    centre = least_squares_centre(xy)
    assert centre == pytest.approx([30.2, -7.3], abs=1e-6)


def test_a_circle_needs_both_senses() -> None:
    with pytest.raises(InsufficientPointsError, match="both ways"):
        circular(np.arange(4.0), np.arange(2.0))
