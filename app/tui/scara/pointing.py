"""Where J4 has to turn so that the beam points at a reflector; pure geometry of the nominal arm."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.protocol.scara.layout import Layout
from catseye.app.tui.jog_client import Step
from catseye.app.tui.scara.plan_drawing import pose_of
from catseye.calibration.scara.pointing import aim, beam_direction, nearest_branch

_LONGEST_DEG = 90.0
"""The engine takes no longer step."""


def pointing_j4_deg(layout: Layout, joints: Sequence[float], name: str) -> float | None:
    """Return J4 that points the beam at a reflector, the nearest within the cell's limits; None when there is none.

    Args:
        joints: J1 deg, J2 deg, J3 mm, J4 deg.
    """
    reflector = layout.reflector(name)
    if reflector is None:
        return None
    place = np.array([reflector.x_mm, reflector.y_mm])
    towards_rad = beam_direction(np.array(pose_of(layout, joints).place_mm), place)
    one, two, here = (np.array(math.radians(joints[axis])) for axis in (0, 1, 3))
    j4_rad = aim(one, two, towards_rad, math.radians(layout.theta40_deg))
    nearest_deg = math.degrees(nearest_branch(j4_rad, here))
    low_deg, high_deg = layout.limits_deg["j4"]
    branches = (
        nearest_deg,
        *sorted((nearest_deg - 360.0, nearest_deg + 360.0), key=lambda j4: abs(j4 - joints[3])),
    )
    return next((j4 for j4 in branches if low_deg <= j4 <= high_deg), None)


@dataclass(frozen=True)
class Turn:
    """A turn of J4 that points the beam at a reflector.

    Attributes:
        text: from where to where.
        steps: that make it.
    """

    text: str
    steps: list[Step]


def turn_towards(layout: Layout, joints: Sequence[float], name: str) -> Turn | str:
    """Return the turn of J4 that points the beam at a reflector, or why there is none; see `pointing_j4_deg`."""
    target_deg, here_deg = pointing_j4_deg(layout, joints, name), joints[3]
    if target_deg is None:
        return f"J4 cannot point at {name} within its limits"
    by_deg = target_deg - here_deg
    return Turn(
        f"J4 turns from {here_deg:.3f} to {target_deg:.3f} deg ({by_deg:+.3f} deg)", turn_of_j4(by_deg)
    )


def turn_of_j4(by_deg: float) -> list[Step]:
    """Return a turn of J4 as steps of equal length that the engine takes."""
    count = max(1, math.ceil(abs(by_deg) / _LONGEST_DEG))
    return [Step("j4", by_deg / count)] * count
