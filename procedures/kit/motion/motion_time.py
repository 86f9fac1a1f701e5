"""How long joint moves take: trapezoidal speed, all joints start and end with the slowest."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from catseye.procedures.kit.bench import Arm


def move_time_s(arm: Arm, travel_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the time of moves, s, shape (n,).

    Args:
        arm: speeds, accelerations and override.
        travel_deg: travel of J1, J2, J4 of each move, deg, shape (n, 3).
    """
    travel = np.abs(travel_deg)
    speed = np.asarray(arm.speed_deg_s) * arm.override_percent / 100.0
    acceleration = np.asarray(arm.acceleration_deg_s2)
    ramps = np.where(
        travel >= speed**2 / acceleration,
        travel / speed + speed / acceleration,
        2.0 * np.sqrt(travel / acceleration),
    )
    slowest: NDArray[np.float64] = ramps.max(axis=1)
    return slowest


def way_time_s(arm: Arm, poses_deg: NDArray[np.float64]) -> float:
    """Return the time of a way through poses, s; how it is driven depends on the arm's way of following.

    Args:
        arm: speeds, accelerations, override and way of following.
        poses_deg: J1, J2, J4 at the start and at each target, deg, shape (n, 3).
    """
    steps = np.abs(np.diff(poses_deg, axis=0))
    if arm.following == "stops":
        return float(move_time_s(arm, steps).sum())
    # Without a stop the whole way is one motion.
    whole = steps.sum(axis=0)[None, :]
    return float(move_time_s(_streaming(arm) if arm.following == "streamed" else arm, whole)[0])


def _streaming(arm: Arm) -> Arm:
    full = np.asarray(arm.speed_deg_s) * arm.override_percent / 100.0
    one, two, four = (float(speed) for speed in np.minimum(full, arm.follow_speed_deg_s))
    # Set points speed up as a squared sine, whose mean acceleration is 2/pi of its largest.
    acceleration = arm.follow_acceleration_deg_s2 * 2.0 / np.pi
    return replace(
        arm,
        speed_deg_s=(one, two, four),
        acceleration_deg_s2=(acceleration, acceleration, acceleration),
        override_percent=100.0,
    )
