"""The speed of a walk, against a sampled arm."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from catseye.app.engine.walked.tube import FASTEST_MM_S, Leg, walking_percent
from catseye.app.errors import SafetyError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.body_speed import fastest_mm_s, top_speed_mm_s
from tests.unit.procedures.benches import LINK1_MM, LINK2_MM, bench, with_axes

BENCH = bench()
RIM_MM = 60.0
"""How far the rim of the head is from the J4 axis: 30 mm behind it, radius 30 mm."""

places = st.tuples(
    st.floats(-170.0, 170.0), st.floats(-145.0, 145.0), st.floats(0.0, 150.0), st.floats(-360.0, 360.0)
)


def head(poses: NDArray[np.float64], ahead_deg: float) -> NDArray[np.float64]:
    """Return where a point on the rim of the head is, mm, shape (n, 3)."""
    one, two, four = (np.deg2rad(poses[:, n]) for n in (0, 1, 3))
    out = one + two + four + math.radians(ahead_deg)
    x = LINK1_MM * np.cos(one) + LINK2_MM * np.cos(one + two) + RIM_MM * np.cos(out)
    y = LINK1_MM * np.sin(one) + LINK2_MM * np.sin(one + two) + RIM_MM * np.sin(out)
    return np.stack([x, y, poses[:, 2]], axis=1)


def driven_mm_s(leg: Leg, percent: float) -> float:
    """Return the fastest of some points on the rim while the motion cruises."""
    full = np.array([420.0, 720.0, 1100.0, 3000.0]) * percent / 100.0
    travel = np.subtract(leg.end, leg.start)
    duration_s = float((np.abs(travel) / full).max())
    share = np.linspace(0.0, 1.0, 400)[:, None]
    poses = leg.start + share * travel
    chords = [
        np.linalg.norm(np.diff(head(poses, ahead), axis=0), axis=1).max() for ahead in range(0, 360, 30)
    ]
    return float(max(chords)) * 399.0 / duration_s


@settings(max_examples=150)
@given(places, places)
def test_nothing_on_the_arm_is_faster_than_250_mm_s(start: Pose, end: Pose) -> None:
    leg = Leg(start, end)
    if np.abs(np.subtract(end, start)).max() < 0.1:  # chords of so short a way are lost in rounding
        return
    percent = walking_percent(BENCH, leg, 20.0)
    assert 1.0 <= percent <= 10.0
    assert driven_mm_s(leg, percent) <= min(FASTEST_MM_S, fastest_mm_s(BENCH, start, end, percent)) + 1e-6


def test_a_slow_motion_is_walked_at_ten_percent() -> None:
    assert walking_percent(BENCH, Leg((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 40.0, 0.0)), 20.0) == 10.0


def test_the_cap_of_the_cell_holds() -> None:
    assert walking_percent(BENCH, Leg((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 40.0, 0.0)), 4.0) == 4.0


def test_an_override_is_whole() -> None:
    percent = walking_percent(BENCH, Leg((0.0, 0.0, 0.0, 0.0), (90.0, 0.0, 0.0, 0.0)), 20.0)
    # 610 mm · 4.2 °/s = 44.7 mm/s at 1 %.
    assert percent == 5.0


def test_too_fast_an_arm_is_refused_with_its_speed() -> None:
    fast = with_axes(BENCH, speeds=(4200.0, 7200.0, 30000.0))
    with pytest.raises(SafetyError, match="cannot be walked, no override is lower"):
        walking_percent(fast, Leg((0.0, 0.0, 0.0, 0.0), (90.0, 150.0, 0.0, 300.0)), 20.0)


def test_top_speed_is_that_of_the_head_s_rim_outstretched() -> None:
    out_mm = LINK1_MM + LINK2_MM + RIM_MM
    rates = np.deg2rad([420.0, 720.0, 3000.0])
    expected = rates @ [out_mm, LINK2_MM + RIM_MM, RIM_MM] + 1100.0
    assert top_speed_mm_s(BENCH, 20.0) == pytest.approx(0.2 * expected)
