"""Where relative motions end: an axis turned by an increment, the tool shifted along a straight line."""

import math
from typing import Final

from catseye.drivers.roles.pose import Axes, Pose, Unit, with_axis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import PlanError

Vector = tuple[float, float, float]
"""Along the axes of the base frame, mm."""

MOST: Final[dict[Unit, float]] = {"deg": 1.0, "mm": 2.0}
"""Largest relative motion: tests of the resolution step by a tenth of a degree and by a millimetre."""


STEP_SPEED: Final = 0.1
"""deg/s or mm/s: resolution tests go at 0.1 % of the full speed of an axis or of the tool, roughly 100."""

_MESSAGES_S: Final = 0.2
"""Spent on looking, sending and asking again, for each step."""


def step_time_s(increment: float) -> float:
    """Return the expected time of a step, s, by its size in deg or mm; its driver sets the true speed."""
    return _MESSAGES_S + abs(increment) / STEP_SPEED


def axis_target(axes: Axes, here: Pose, axis: str, increment: float) -> Pose:
    """Return the joints after a step of one axis, deg or mm.

    Raises:
        ValueError: the arm has no such axis.
    """
    number = [each.name for each in axes].index(axis)
    return with_axis(here, number, here[number] + increment)


def largest_change(here: Pose, target: Pose) -> float:
    """Return the signed change of the axis that changes most, deg or mm."""
    return max((to - at for at, to in zip(here, target, strict=True)), key=abs)


def length_mm(shift_mm: Vector) -> float:
    """Return the length of a shift, mm."""
    return math.hypot(*shift_mm)


def line_target(bench: Bench, here: Pose, shift_mm: Vector) -> Pose:
    """Return the joints after a straight shift of the last frame, orientation kept, nearest to where they were.

    Raises:
        PlanError: the arm cannot make it.
    """
    # Numpy and scipy come with it: clients of an engine start without.
    import numpy as np

    from catseye.calibration.kinematics.inverse import inverse_kinematics

    chain, start = bench.workspace.chain, np.array([here])
    target = chain.frames(start)[-1].copy()
    target[:, :3, 3] += shift_mm
    found = inverse_kinematics(chain, target, start[0])
    if found.refused:
        raise PlanError(
            f"the arm cannot shift its tool by ({shift_mm[0]:g}, {shift_mm[1]:g}, {shift_mm[2]:g}) mm from here: "
            f"{found.refused[0].reason}; choose another pose"
        )
    return tuple(map(float, found.poses[0]))
