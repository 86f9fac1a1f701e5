"""ISO 230-2 against worked tables and closed forms."""

import math

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.standards.iso230_2 import (
    NAMES,
    SYSTEMATIC,
    positioning,
    systematic,
    systematic_of_map,
)

UP_UM = np.array([[0, 1, 2, 3, 4], [10, 10, 10, 10, 10], [-4, -2, 0, 2, 4]], dtype=float)
DOWN_UM = np.array([[-6, -5, -4, -3, -2], [4, 6, 8, 6, 6], [-8, -8, -8, -8, -8]], dtype=float)

UP_ARCSEC = np.array(
    [
        [1.08, 0.79, 2.17, 0.81, 0.49],
        [3.15, 3.38, 2.75, 4.17, 2.77],
        [4.69, 3.7, 4.32, 2.75, 4.96],
        [3.33, 3.37, 3.22, 3.38, 2.89],
        [1.43, 1.07, 0.56, 1.29, 0.83],
        [-1.1, 0.36, -0.6, -1.24, -0.19],
        [-2.22, -1.82, -1.72, -1.26, -1.2],
        [-1.29, -1.38, -0.64, -0.5, -1.8],
    ]
)
DOWN_ARCSEC = np.array(
    [
        [-0.79, -1.2, -1.32, -1.45, -2.02],
        [1.34, 1.31, 0.07, 1.17, 1.13],
        [1.52, 1.73, 1.99, 1.66, 1.54],
        [2.02, 1.4, 1.06, 0.45, 0.49],
        [-0.59, -1.31, -1.04, -1.58, -0.9],
        [-2.95, -3.86, -3.76, -3.76, -3.33],
        [-3.94, -4.4, -4.58, -4.12, -4.09],
        [-3.09, -3.26, -3.55, -3.43, -3.58],
    ]
)


def test_a_linear_axis_worked_by_hand() -> None:
    found = positioning(UP_UM, DOWN_UM)
    assert found.mean_up == pytest.approx([2.0, 10.0, 0.0])
    assert found.mean_down == pytest.approx([-4.0, 6.0, -8.0])
    assert found.s_up == pytest.approx([math.sqrt(2.5), 0.0, math.sqrt(10.0)])
    assert found.s_down == pytest.approx([math.sqrt(2.5), math.sqrt(2.0), 0.0])
    assert found.reversal == pytest.approx([6.0, 4.0, 8.0])
    assert found.repeatability == pytest.approx([12.324555, 6.828427, 14.324555], abs=1e-6)
    assert found.quantities == {
        "B": 8.0,
        "B̄": 6.0,
        "M": 12.0,
        "E": 18.0,
        "E↑": 10.0,
        "E↓": 14.0,
        "R": pytest.approx(14.324555, abs=1e-6),
        "R↑": pytest.approx(12.649111, abs=1e-6),
        "R↓": pytest.approx(6.324555, abs=1e-6),
        "A": 18.0,
        "A↑": pytest.approx(16.324555, abs=1e-6),
        "A↓": pytest.approx(16.828427, abs=1e-6),
    }


def test_a_rotary_axis_with_eight_targets() -> None:
    found = positioning(UP_ARCSEC, DOWN_ARCSEC).quantities
    expected = {"B": 2.978, "B̄": 2.3942, "M": 5.821, "E": 8.31, "E↑": 5.728, "E↓": 5.914}
    expected |= {"R↑": 3.5312, "R↓": 2.6316, "R": 5.0654, "A": 10.5924, "A↑": 8.3381, "A↓": 7.1426}
    assert set(found) == set(NAMES)
    for symbol, value in expected.items():
        assert found[symbol] == pytest.approx(value, abs=6e-4 if symbol in SYSTEMATIC else 6e-5), symbol


def test_scatter_alone_can_be_the_bidirectional_repeatability() -> None:
    # Equal means: 2 s↑ + 2 s↓ is smaller than 4 s of the worse side.
    up = np.array([[-3.0, 3.0], [-3.0, 3.0]])
    found = positioning(up, np.zeros((2, 2)))
    assert found.repeatability == pytest.approx([4.0 * math.sqrt(18.0)] * 2)


def test_one_approach_has_no_repeatability() -> None:
    with pytest.raises(InsufficientPointsError, match="two approaches or more"):
        positioning(UP_UM[:, :1], DOWN_UM)


def test_draws_are_evaluated_at_once() -> None:
    rng = np.random.default_rng(1)
    up, down = rng.normal(size=(2, 7, 5))
    stacked = systematic(up, down)
    for i in range(7):
        assert stacked[i] == pytest.approx(systematic(up[i], down[i]))


def test_the_uncertainty_of_linear_quantities_is_the_closed_form() -> None:
    rng = np.random.default_rng(2)
    mixing = rng.normal(0.0, 0.3, (8, 8))
    covariance = mixing @ mixing.T
    mean = np.array([0.0, 30.0, 10.0, 5.0, -12.0, 18.0, -2.0, -7.0])
    found = {one.symbol: one for one in systematic_of_map(mean, covariance, draws=40_000)}
    average = np.repeat([0.25, -0.25], 4)
    assert found["B̄"].u == pytest.approx(math.sqrt(average @ covariance @ average), rel=0.02)
    assert found["B̄"].excess == pytest.approx(0.0, abs=0.02)
    # Far from any competitor a largest difference is a plain difference: of nodes 1 and 0 upwards, 1 and 0 downwards.
    for symbol, high, low in (("E↑", 1, 0), ("E↓", 5, 4), ("E", 1, 4)):
        step = np.zeros(8)
        step[high], step[low] = 1.0, -1.0
        assert found[symbol].value == mean[high] - mean[low]
        assert found[symbol].u == pytest.approx(math.sqrt(step @ covariance @ step), rel=0.02)


def test_noise_widens_a_range_by_the_excess() -> None:
    # The range of five standard normal values: mean 2.326 and standard deviation 0.864 (tables of d2, d3).
    found = {one.symbol: one for one in systematic_of_map(np.zeros(10), np.eye(10), draws=100_000)}
    assert found["E↑"].value == 0.0
    assert found["E↑"].excess == pytest.approx(2.326, abs=0.01)
    assert found["E↑"].u == pytest.approx(0.864, abs=0.01)
    assert found["E"].excess == pytest.approx(3.078, abs=0.01)
    assert found["M"].excess == pytest.approx(2.326 / math.sqrt(2.0), abs=0.01)
    # The largest of five |N(0, 2)|: the standard deviation of a difference is √2.
    assert found["B"].excess > 1.5


def test_a_map_without_uncertainty_has_none() -> None:
    for one in systematic_of_map(np.arange(6.0), np.zeros((6, 6)), draws=200):
        assert one.u == 0.0
        assert one.excess == pytest.approx(0.0, abs=1e-12)
        assert one.name
