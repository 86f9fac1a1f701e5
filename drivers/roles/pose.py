"""Poses of an arm with any number of axes, and the axes that name their values."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

Pose = tuple[float, ...]
"""One value per axis, in the order of the arm description: deg of a revolute axis, mm of a prismatic one."""

Range = tuple[float, float]
"""Lowest and highest value, deg or mm."""

Unit = Literal["deg", "mm"]

SAME_PLACE: Final = 0.03
"""Axes that differ by more, deg or mm, were moved by somebody else: encoders and rounding stay far below."""

SYMBOLS: Final[dict[Unit, str]] = {"deg": "°", "mm": " mm"}
"""What stands behind a value on screens."""


@dataclass(frozen=True)
class Axis:
    """One axis of an arm, as the arm description has it and the cell file narrows it.

    Attributes:
        name: as the arm's maker numbers it.
        unit: of its values.
        low: smallest value.
        high: largest value.
        speed: fastest at 100 % override, deg/s or mm/s.
        acceleration: deg/s² or mm/s²; None where it is unknown: estimates of time reckon with the speed alone.
    """

    name: str
    unit: Unit
    low: float
    high: float
    speed: float
    acceleration: float | None = None

    @property
    def range(self) -> Range:
        """Lowest and highest value, deg or mm."""
        return self.low, self.high

    def allows(self, value: float) -> bool:
        """Return whether a value is a number within the range."""
        return math.isfinite(value) and self.low <= value <= self.high

    def text(self, value: float, digits: int = 2) -> str:
        """Return a value with name and unit: A1 10.00°, or 12.50 mm."""
        return f"{self.name} {value:z.{digits}f}{SYMBOLS[self.unit]}"


Axes = tuple[Axis, ...]
"""The axes of an arm, from the base outwards."""


def pose_of(axes: Axes, values: Iterable[float]) -> Pose:
    """Return values as a pose; a driver may report a list or whole numbers.

    Raises:
        ValueError: their number is not that of the axes.
    """
    pose = tuple(float(value) for value in values)
    if len(pose) != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"{len(pose)} values where the arm has {len(axes)} axes ({names})")
    return pose


def pose_text(axes: Axes, pose: Sequence[float], digits: int = 2) -> str:
    """Return a pose for people: A1 10.00°, A2 20.00°, Z 12.50 mm."""
    return ", ".join(axis.text(value, digits) for axis, value in zip(axes, pose, strict=True))


def out_of_range(axes: Axes, pose: Pose) -> list[str]:
    """Return a sentence for each axis that is outside its range or not a number."""
    return [
        f"{axis.name} = {value:g} {axis.unit} is outside {axis.low:g} … {axis.high:g} {axis.unit}"
        for axis, value in zip(axes, pose, strict=True)
        if not axis.allows(value)
    ]


def is_at(pose: Pose, target: Pose, tolerance: float = SAME_PLACE) -> bool:
    """Return whether no axis is farther from a target than the tolerance, deg or mm."""
    return all(abs(a - b) <= tolerance for a, b in zip(pose, target, strict=True))


def with_axis(pose: Pose, number: int, value: float) -> Pose:
    """Return a pose with another value of one axis, counted from 0."""
    return (*pose[:number], value, *pose[number + 1 :])


def between(start: Pose, end: Pose, share: float) -> Pose:
    """Return the pose at a share of the straight motion from start to end."""
    return tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
