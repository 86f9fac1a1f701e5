"""Poses of an arm with any number of axes."""

from typing import Final

Pose = tuple[float, ...]
"""One value per axis, from the base outwards: deg of a revolute axis, mm of a prismatic one."""

Range = tuple[float, float]
"""Lowest and highest value of an axis, deg or mm."""

SAME_PLACE: Final = 0.03
"""Axes that differ by more, deg or mm, were moved by somebody else: encoders and rounding stay far below."""


def is_at(pose: Pose, target: Pose, tolerance: float = SAME_PLACE) -> bool:
    """Return whether no axis is farther from a target than the tolerance, deg or mm."""
    return all(abs(a - b) <= tolerance for a, b in zip(pose, target, strict=True))
