"""ISO 9283 against positions placed by hand."""

import math

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.standards.iso9283 import (
    distance,
    pose,
    pose_repeatability,
)

ATTAINED = np.array(
    [[3, 4, 0], [3, 4, 12], [3, -8, 0], [-9, 4, 0], [3, 4, -12], [3, 16, 0], [15, 4, 0]], dtype=float
)


def test_positions_on_a_sphere_and_in_its_centre() -> None:
    found = pose(ATTAINED, np.zeros(3))
    assert found.n == 7
    assert found.barycentre == pytest.approx([3.0, 4.0, 0.0])
    assert found.accuracy_of_axes == pytest.approx([3.0, 4.0, 0.0])
    assert found.accuracy == pytest.approx(5.0)
    assert found.repeatability == pytest.approx(72.0 / 7.0 + 3.0 * 12.0 / math.sqrt(7.0))
    assert found.repeatability == pytest.approx(23.8924353, abs=1e-6)


def test_positions_all_one_away() -> None:
    axes = np.vstack([np.eye(3), -np.eye(3)]) + np.array([6.0, 2.0, 3.0])
    found = pose(axes, np.zeros(3))
    assert found.accuracy == pytest.approx(7.0)
    assert found.repeatability == pytest.approx(1.0)


def test_distances() -> None:
    found = distance(np.array([500.02, 500.01, 499.99, 500.00, 500.03]), 500.0)
    assert found.n == 5
    assert found.accuracy == pytest.approx(0.01, abs=1e-9)
    assert found.repeatability == pytest.approx(0.0474342, abs=1e-7)


def test_one_value_has_no_spread() -> None:
    for call in (
        lambda: pose_repeatability(ATTAINED[:1]),
        lambda: distance(np.array([500.0]), 500.0),
    ):
        with pytest.raises(InsufficientPointsError, match="30 cycles"):
            call()
