"""A way that was cut short: what is left of it for an arm that was stopped on it."""

import math
from collections.abc import Sequence
from itertools import pairwise

from catseye.drivers.roles.pose import Pose

_BESIDE = 0.5
"""An arm that is stopped, or passes a corner of its way, stays nearer to it than this, deg or mm; whoever moves it by
hand seldom does."""


def rest_of_way(start: Pose, way: Sequence[Pose], here: Pose) -> tuple[Pose, ...] | None:
    """Return the targets that are still ahead, so that what is driven is a part of the way that was checked.

    Args:
        start: where the way began.
        way: its targets; between them all joints move in proportion.
        here: where the arm stands.

    Returns:
        None when the arm does not stand on the way.
    """
    beside = [_beside(a, b, here) for a, b in pairwise((start, *way))]
    nearest = min(range(len(beside)), key=beside.__getitem__)
    return tuple(way[nearest:]) if beside[nearest] <= _BESIDE else None


def _beside(a: Pose, b: Pose, here: Pose) -> float:
    """Return how far a place is beside a leg: the largest difference of a joint to the leg's nearest place."""
    along = [to - at for at, to in zip(a, b, strict=True)]
    length2 = math.fsum(step * step for step in along)
    passed = math.fsum((now - at) * step for now, at, step in zip(here, a, along, strict=True))
    share = min(1.0, max(0.0, passed / length2)) if length2 > 0.0 else 0.0
    return max(abs(now - at - share * step) for now, at, step in zip(here, a, along, strict=True))
