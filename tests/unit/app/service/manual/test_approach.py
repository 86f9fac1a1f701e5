"""No joint comes nearer to its limit than it should, whatever its speed and whenever it is looked at."""

from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.service.manual.approach import MARGIN, STOP_S, Approach

FASTEST_DEG_S = 40.0
LIMITS = (-170.0, 170.0)
WAYS: st.SearchStrategy[Literal[-1, 1]] = st.sampled_from([-1, 1])


@given(
    speed_deg_s=st.floats(0.0, FASTEST_DEG_S),
    start_deg=st.floats(-150.0, 150.0),
    way=WAYS,
    looks_s=st.lists(st.floats(0.01, 0.3), min_size=1, max_size=400),
    resolution_deg=st.sampled_from([0.0, 0.01]),
)
def test_a_joint_that_is_stopped_in_time_keeps_its_distance(
    speed_deg_s: float, start_deg: float, way: Literal[-1, 1], looks_s: list[float], resolution_deg: float
) -> None:
    """It turns at its speed, is stopped when it is told to, or not seen again in time, and needs STOP_S for that."""
    approach = Approach(LIMITS, way, FASTEST_DEG_S)

    def angle_deg(time_s: float) -> float:
        return start_deg + way * speed_deg_s * time_s

    def reported_deg(time_s: float) -> float:
        exact = angle_deg(time_s)
        return round(exact / resolution_deg) * resolution_deg if resolution_deg else exact

    time_s = 0.0
    free_s = approach.free_s(0.0, reported_deg(0.0))
    for pause_s in looks_s:
        if free_s <= 0.0 or pause_s >= free_s:
            break
        time_s += pause_s
        free_s = approach.free_s(time_s, reported_deg(time_s))
    else:
        return
    stopped_deg = angle_deg(time_s + max(0.0, free_s) + STOP_S)
    assert LIMITS[0] <= stopped_deg <= LIMITS[1]
    if free_s > 0.0:
        assert approach.left(stopped_deg) >= MARGIN - 0.02


def test_before_its_speed_is_seen_the_fastest_counts() -> None:
    approach = Approach(LIMITS, 1, FASTEST_DEG_S)
    # 21 deg to the limit, 1 to spare: 0.5 s at 40 deg/s, of which stopping takes 0.2 s.
    assert approach.free_s(0.0, 149.0) == pytest.approx(0.3)
    assert approach.free_s(0.1, 149.0) == pytest.approx(0.3)


def test_a_steady_speed_counts_twice() -> None:
    approach = Approach(LIMITS, -1, FASTEST_DEG_S)
    for number in range(3):
        approach.free_s(0.1 * number, -100.0 - 0.5 * number)
    # 5 deg/s, so 10 deg/s: 68.5 deg to the limit, 1 to spare.
    assert approach.free_s(0.3, -101.5) == pytest.approx(6.75 - 0.2)


def test_a_joint_that_stood_is_taken_for_fast_again() -> None:
    approach = Approach(LIMITS, 1, FASTEST_DEG_S)
    for number in range(4):
        approach.free_s(0.1 * number, 100.0 + 0.5 * number)
    assert approach.free_s(0.4, 101.5) == pytest.approx(67.5 / FASTEST_DEG_S - 0.2)


def test_beyond_its_limit_a_joint_can_only_move_back() -> None:
    assert Approach(LIMITS, 1, 1.0).free_s(0.0, 171.0) < 0.0
    assert Approach(LIMITS, -1, 1.0).free_s(0.0, 171.0) > 300.0
