"""How fast the outermost body of an arm can be on a motion, and the override that keeps it slow enough."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from app.errors import SafetyError
from app.walk.tube import Leg
from procedures.bench import Arm

FASTEST_MM_S: Final = 250.0
"""Of anything on the arm while it is walked."""

MOST_PERCENT: Final = 10.0
"""Override of a walk."""

_LEAST_PERCENT: Final = 1.0

HEAD_RADIUS_MM: Final = 150.0
"""Estimate: no cell file says how far the interferometer and its cables stand out from the J4 axis."""


def outermost_mm(arm: Arm) -> NDArray[np.float64]:
    """Return how far the outermost body can be from the axes of J1, J2 and J4, mm, shape (3,)."""
    return np.array([arm.link1_mm + arm.link2_mm, arm.link2_mm, 0.0]) + HEAD_RADIUS_MM


def fastest_mm_s(arm: Arm, leg: Leg, percent: float) -> float:
    """Return a bound of the speed of anything on the arm during a motion, mm/s.

    All joints begin and end together, so the one that needs longest sets the pace of the others. Every joint is
    taken to turn the outermost body with the longest lever that there is, all in the same direction.

    Args:
        arm: links and fastest joints at 100 % override, as the cell file states them.
        leg: the motion.
        percent: speed override.
    """
    travel = np.abs(np.subtract(leg.end, leg.start))
    fastest = np.array([*arm.speed_deg_s[:2], arm.j3_speed_mm_s, arm.speed_deg_s[2]]) * percent / 100.0
    duration_s = float((travel / fastest).max())
    if duration_s == 0.0:
        return 0.0
    around_mm = float(np.deg2rad(travel[[0, 1, 3]]) @ outermost_mm(arm))
    return math.hypot(around_mm, float(travel[2])) / duration_s


def walking_percent(arm: Arm, leg: Leg, cap_percent: float) -> float:
    """Return the highest whole override with which a motion is walked.

    Args:
        arm: links and fastest joints.
        leg: the motion.
        cap_percent: what the cell allows.

    Raises:
        SafetyError: the motion is too fast with the lowest override that controllers take.
    """
    most = min(MOST_PERCENT, cap_percent)
    at_one = fastest_mm_s(arm, leg, _LEAST_PERCENT)
    percent = most if at_one * most <= FASTEST_MM_S else float(math.floor(FASTEST_MM_S / at_one))
    if percent < _LEAST_PERCENT:
        raise SafetyError(
            f"the motion to {place_text(leg.end)} moves the outermost body at up to {at_one:.0f} mm/s with an "
            f"override of {_LEAST_PERCENT:g} %, and a walk at {FASTEST_MM_S:g} mm/s at most: it cannot be walked, no "
            "override is lower; check [robot] speed_deg_s and the links, or drive it by hand"
        )
    return percent


def place_text(joints: tuple[float, float, float, float]) -> str:
    """Return where an arm stands, for people."""
    one, two, three, four = joints
    return f"J1 {one:.2f}°, J2 {two:.2f}°, J3 {three:.1f} mm, J4 {four:.2f}°"
