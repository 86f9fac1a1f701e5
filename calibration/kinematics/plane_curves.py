"""Arcs in a plane: about a centre, or through three points; angles count counter-clockwise."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

_ON_A_LINE_MM = 1e-3
"""A point this near to the chord of two others fixes no circle that anybody meant."""


@dataclass(frozen=True)
class Arc:
    """Part of a circle, or all of it.

    Attributes:
        centre_mm: shape (2,).
        start_mm: where it begins, shape (2,).
        sweep_rad: angle that it turns by; positive is counter-clockwise.
        end_radius_mm: distance of its end from the centre: rounded places leave it a little different from that of
            its beginning.
    """

    centre_mm: Floats
    start_mm: Floats
    sweep_rad: float
    end_radius_mm: float

    @property
    def radius_mm(self) -> float:
        """Distance of its beginning from the centre, mm."""
        return float(np.hypot(*(self.start_mm - self.centre_mm)))

    @property
    def length_mm(self) -> float:
        """Length along it, mm."""
        return self.radius_mm * abs(self.sweep_rad)

    def at(self, share: Floats) -> Floats:
        """Return the places at shares 0...1 of the arc, mm, shape (n, 2)."""
        arm = self.start_mm - self.centre_mm
        radius = self.radius_mm + share * (self.end_radius_mm - self.radius_mm)
        angle = np.arctan2(arm[1], arm[0]) + share * self.sweep_rad
        around = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        return np.asarray(self.centre_mm + around, dtype=np.float64)


def turned_rad(centre_mm: Floats, start_mm: Floats, end_mm: Floats) -> float:
    """Return the angle from one place to another about a centre, counter-clockwise, rad, in [0, 2 pi)."""
    a, b = start_mm - centre_mm, end_mm - centre_mm
    return float(np.mod(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b), 2.0 * np.pi))


def circle_through(first_mm: Floats, second_mm: Floats, third_mm: Floats) -> tuple[Floats, int]:
    """Return the centre of the circle through three places, and the sense in which they follow each other.

    Returns:
        The centre, mm, shape (2,), and 1 for counter-clockwise, -1 for clockwise.

    Raises:
        KinematicsError: they lie on a line.
    """
    b, c = second_mm - first_mm, third_mm - first_mm
    cross = float(b[0] * c[1] - b[1] * c[0])
    if abs(cross) <= _ON_A_LINE_MM * max(float(np.hypot(*side)) for side in (b, c, c - b)):
        raise KinematicsError("the three places lie on a line, so that no circle passes through them")
    square_b, square_c = float(b @ b), float(c @ c)
    centre = np.array([c[1] * square_b - b[1] * square_c, b[0] * square_c - c[0] * square_b]) / (2.0 * cross)
    return np.asarray(first_mm + centre, dtype=np.float64), 1 if cross > 0.0 else -1
