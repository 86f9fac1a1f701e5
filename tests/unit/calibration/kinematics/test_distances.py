"""Distances in space against minima that are looked for on a grid."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.distances import depth_in_box_mm, segment_to_box_mm, segment_to_segment_mm

SHARE = np.linspace(0.0, 1.0, 401)
RNG = np.random.default_rng(8)
STARTS, ENDS, OTHERS, LAST = RNG.uniform(-100.0, 100.0, (4, 60, 3))


def points(start: Floats, end: Floats) -> Floats:
    return np.asarray(start + SHARE[:, None] * (end - start))


def test_segments_are_as_far_apart_as_their_nearest_points() -> None:
    found = segment_to_segment_mm(STARTS, ENDS, OTHERS, LAST)
    for row, start, end, other, last in zip(found, STARTS, ENDS, OTHERS, LAST, strict=True):
        gaps = np.linalg.norm(points(start, end)[:, None] - points(other, last), axis=-1)
        assert row == pytest.approx(gaps.min(), abs=0.3)
        assert row <= gaps.min() + 1e-9


@pytest.mark.parametrize(
    ("start", "end", "wanted"),
    [
        ((0, 10, 0), (50, 10, 0), 10.0),
        ((120, 0, 0), (150, 0, 0), 20.0),
        ((50, 0, 7), (50, 0, 7), 7.0),
        ((-5, -5, 0), (5, 5, 0), 0.0),
    ],
)
def test_parallel_short_and_crossing_segments(
    start: tuple[int, ...], end: tuple[int, ...], wanted: float
) -> None:
    ends = (np.array(one, dtype=np.float64) for one in (start, end, (0, 0, 0), (100, 0, 0)))
    assert float(segment_to_segment_mm(*ends)) == pytest.approx(wanted, abs=1e-9)


def test_box_distance_is_that_of_the_nearest_segment_point() -> None:
    low, high = np.array([-30.0, -20.0, -60.0]), np.array([40.0, 10.0, 5.0])
    found = segment_to_box_mm(STARTS, ENDS, low, high)
    for row, start, end in zip(found, STARTS, ENDS, strict=True):
        way = points(start, end)
        gaps = np.linalg.norm(way - np.clip(way, low, high), axis=-1)
        assert row == pytest.approx(gaps.min(), abs=0.5)
        assert row <= gaps.min() + 1e-9


def test_a_segment_parallel_to_an_axis_meets_the_box() -> None:
    low, high = np.zeros(3), np.full(3, 10.0)
    along_x = segment_to_box_mm(np.array([-50.0, 5.0, 12.0]), np.array([50.0, 5.0, 12.0]), low, high)
    through = segment_to_box_mm(np.array([-50.0, 5.0, 5.0]), np.array([50.0, 5.0, 5.0]), low, high)
    assert float(along_x) == pytest.approx(2.0)
    assert float(through) == 0.0


def test_depth_in_a_box_is_that_of_the_shallower_end() -> None:
    low, high = np.zeros(3), np.full(3, 100.0)
    deep = depth_in_box_mm(np.array([50.0, 50.0, 50.0]), np.array([90.0, 50.0, 50.0]), low, high)
    out = depth_in_box_mm(np.array([50.0, 50.0, 50.0]), np.array([50.0, 107.0, 50.0]), low, high)
    assert (float(deep), float(out)) == (10.0, -7.0)
