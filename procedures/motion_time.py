"""How long joint moves take: trapezoidal speed, all joints start and end with the slowest."""

import numpy as np
from numpy.typing import NDArray

from procedures.bench import Arm


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
