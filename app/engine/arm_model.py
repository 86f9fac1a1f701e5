"""The arm as the dry run sees it: where it passes, and where the beam goes."""

import math
from collections.abc import Callable, Mapping

from procedures.devices import Joints

Beam = Callable[[Joints], float | None]
"""Length of the beam at a pose, mm; None where it does not return."""


def reflector_beam(
    link1_mm: float,
    link2_mm: float,
    reflectors_mm: Mapping[str, tuple[float, float]],
    acceptance_mm: float,
    theta40_deg: float = 0.0,
) -> Beam:
    """Return the beam of an ideal arm: it returns from the nearest reflector that it hits.

    Args:
        link1_mm: length of link 1.
        link2_mm: length of link 2.
        reflectors_mm: x and y by name.
        acceptance_mm: largest distance between a reflector's centre and the beam.
        theta40_deg: direction of the beam at J4 = 0 on a straight arm along +X.
    """

    def beam(joints: Joints) -> float | None:
        theta1, both = math.radians(joints[0]), math.radians(joints[0] + joints[1])
        x_mm = link1_mm * math.cos(theta1) + link2_mm * math.cos(both)
        y_mm = link1_mm * math.sin(theta1) + link2_mm * math.sin(both)
        direction = both + math.radians(joints[3] + theta40_deg)
        lengths = []
        for reflector_x_mm, reflector_y_mm in reflectors_mm.values():
            dx, dy = reflector_x_mm - x_mm, reflector_y_mm - y_mm
            along = dx * math.cos(direction) + dy * math.sin(direction)
            miss = abs(dy * math.cos(direction) - dx * math.sin(direction))
            if along > 0.0 and miss <= acceptance_mm:
                lengths.append(math.hypot(dx, dy))
        return min(lengths, default=None)

    return beam


def poses_between(start: Joints, target: Joints, step: float = 1.0) -> list[Joints]:
    """Return poses on the way, the target included, no joint further apart than a step (deg or mm)."""
    count = max(1, math.ceil(max(abs(b - a) for a, b in zip(start, target, strict=True)) / step))
    return [_between(start, target, number / count) for number in range(1, count + 1)]


def _between(start: Joints, target: Joints, share: float) -> Joints:
    j1, j2, j3, j4 = (a + (b - a) * share for a, b in zip(start, target, strict=True))
    return j1, j2, j3, j4
