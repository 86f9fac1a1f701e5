"""A wrong sighting against right ones made by hand."""

import math

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.reflector_search import Sightings, locate_reflectors
from catseye.calibration.scara.search_outlier import Outlier, find_outlier

PLACES = [(650.0, -400.0), (680.0, 10.0)]
POSES = [
    (-110.0, 40.0),
    (-60.0, 80.0),
    (-20.0, 30.0),
    (0.0, 100.0),
    (30.0, 60.0),
    (50.0, 20.0),
    (-90.0, 120.0),
]


def sighted(noise_rad: Floats) -> Sightings:
    rows = []
    for which, (x, y) in enumerate(PLACES):
        for one_deg, two_deg in POSES:
            one, both = math.radians(one_deg), math.radians(one_deg + two_deg)
            px = 325 * math.cos(one) + 225 * math.cos(both)
            py = 325 * math.sin(one) + 225 * math.sin(both)
            rows.append((one, both - one, math.atan2(y - py, x - px) - both - 0.02, which))
    table = np.array(rows)
    return Sightings(table[:, 0], table[:, 1], table[:, 2] + noise_rad, table[:, 3].astype(np.int64))


def outlier(noise_rad: Floats, least_mm: float = 0.5) -> Outlier | None:
    seen = sighted(noise_rad)
    found = locate_reflectors(seen, 325.0, 225.0, np.array(PLACES))
    return find_outlier(seen, found, 325.0, 225.0, least_mm)


@pytest.mark.parametrize("row", [0, 6, 9, 13])
@pytest.mark.parametrize("off_deg", [0.5, -4.0])
def test_the_outlier_is_identified_with_its_size(row: int, off_deg: float) -> None:
    noise = np.random.default_rng(row).normal(0.0, 2e-4, 14)
    noise[row] += math.radians(off_deg)
    found = outlier(noise)
    assert found is not None
    assert found.row == row
    assert math.degrees(found.off_rad) == pytest.approx(off_deg, abs=0.12)
    one, two = (math.radians(angle) for angle in POSES[row % 7])
    px = 325 * math.cos(one) + 225 * math.cos(one + two)
    py = 325 * math.sin(one) + 225 * math.sin(one + two)
    length = math.dist((px, py), PLACES[row // 7])
    assert found.off_mm == pytest.approx(found.off_rad * length, rel=0.01)


def test_false_alarms_are_rare() -> None:
    alarms = sum(
        outlier(np.random.default_rng(seed).normal(0.0, 3e-3, 14), least_mm=0.0) is not None
        for seed in range(300)
    )
    # One in a thousand searches; three in 300 would have a chance below 0.5 %.
    assert alarms <= 2


def test_what_harms_nobody_is_no_outlier() -> None:
    noise = np.zeros(14)
    noise[3] = 1e-4
    assert outlier(noise, least_mm=0.5) is None
    assert outlier(noise, least_mm=0.01) is not None


def test_too_few_others_judge_nobody() -> None:
    full = sighted(np.zeros(14))
    few = full.select(np.isin(np.arange(14), [0, 1, 2, 7, 8, 9, 10]))
    wrong = Sightings(few.theta1_rad, few.theta2_rad, few.j4_rad + np.eye(7)[2] * 0.05, few.reflector)
    found = locate_reflectors(wrong, 325.0, 225.0, np.array(PLACES))
    assert find_outlier(wrong, found, 325.0, 225.0, 0.5) is None
