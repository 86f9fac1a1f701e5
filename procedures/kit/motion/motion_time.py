"""How long joint moves take, and how fast they are: trapezoidal speed, all axes start and end with the slowest.

An axis whose acceleration the cell does not state is reckoned with its speed alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.procedures.kit.bench import Arm

Floats = NDArray[np.float64]

_MOVING = 1e-9
"""An axis that travels less, deg or mm, stands."""


@dataclass(frozen=True)
class _Pace:
    """What the axes can do.

    Attributes:
        speed: fastest, deg/s or mm/s, shape (axes,).
        acceleration: largest, deg/s² or mm/s², shape (axes,); infinite where none is stated.
    """

    speed: Floats
    acceleration: Floats


def move_time_s(arm: Arm, travel: Floats) -> Floats:
    """Return the time of moves, s, shape (n,).

    Args:
        travel: of each axis in each move, deg or mm, shape (n, axes).
    """
    return _time_s(_pace(arm), travel)


def way_time_s(arm: Arm, poses: Floats) -> float:
    """Return the time of a way through poses, s; how it is driven depends on the arm's way of following.

    Args:
        poses: the start and each target, deg or mm, shape (n, axes).
    """
    steps = np.abs(np.diff(poses, axis=0))
    if arm.following == "stops":
        return float(move_time_s(arm, steps).sum())
    # Without a stop the whole way is one motion.
    whole = steps.sum(axis=0)[None, :]
    return float(_time_s(_following(arm), whole)[0])


def leg_rates(arm: Arm, travel: Floats) -> Floats:
    """Return how fast the legs of a way are driven at their fastest, legs in a second, shape (n,).

    Args:
        travel: of each axis on each leg, deg or mm, shape (n, axes).
    """
    pace = _following(arm)
    travel = np.abs(travel)
    # A robot that passes its targets speeds up once for the whole way.
    run_up = travel if arm.following == "stops" else np.tile(travel.sum(axis=0), (len(travel), 1))
    reached = np.minimum(pace.speed, np.sqrt(np.maximum(run_up, _MOVING) * pace.acceleration))
    moving = travel > _MOVING
    rates = np.where(moving, reached / np.where(moving, travel, 1.0), np.inf).min(axis=1, initial=np.inf)
    return np.where(np.isfinite(rates), rates, 0.0)


def _time_s(pace: _Pace, travel: Floats) -> Floats:
    travel = np.abs(travel)
    ramps = np.where(
        travel >= pace.speed**2 / pace.acceleration,
        travel / pace.speed + pace.speed / pace.acceleration,
        2.0 * np.sqrt(travel / pace.acceleration),
    )
    slowest: Floats = ramps.max(axis=1, initial=0.0)
    return slowest


def _pace(arm: Arm) -> _Pace:
    """Return what the axes can do in a motion of its own."""
    share = arm.override_percent / 100.0
    stated = [np.inf if axis.acceleration is None else axis.acceleration for axis in arm.axes]
    return _Pace(np.array([axis.speed * share for axis in arm.axes]), np.array(stated))


def _following(arm: Arm) -> _Pace:
    """Return what the axes can do while the arm follows a path."""
    pace = _pace(arm)
    if arm.following != "streamed":
        return pace
    turning = np.array([axis.unit == "deg" for axis in arm.axes])
    # Set points speed up as a squared sine, whose mean acceleration is 2/pi of its largest.
    acceleration = arm.follow_acceleration_deg_s2 * 2.0 / np.pi
    return _Pace(
        np.where(turning, np.minimum(pace.speed, arm.follow_speed_deg_s), pace.speed),
        np.where(turning, acceleration, pace.acceleration),
    )
