"""Places on the floor at which a reflector could stand."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import (
    require_count,
    require_not_negative,
    require_positive,
    require_range,
)
from catseye.calibration.core.types import Bools, Floats


@dataclass(frozen=True)
class Floor:
    """Where reflectors may stand.

    Attributes:
        x_mm: smallest and largest x.
        y_mm: smallest and largest y.
        radius_mm: largest distance from the J1 axis.
    """

    x_mm: tuple[float, float]
    y_mm: tuple[float, float]
    radius_mm: float = np.inf

    def __post_init__(self) -> None:
        require_range(self.x_mm, "x_mm")
        require_range(self.y_mm, "y_mm")
        require_positive(self.radius_mm, "radius_mm", infinite=True)

    def holds(self, xy_mm: Floats) -> Bools:
        """Return which places lie on it, shape (...), of places of shape (..., 2), mm."""
        x, y = xy_mm[..., 0], xy_mm[..., 1]
        return np.asarray(
            (x >= self.x_mm[0])
            & (x <= self.x_mm[1])
            & (y >= self.y_mm[0])
            & (y <= self.y_mm[1])
            & (np.hypot(x, y) <= self.radius_mm)
        )


def grid(floor: Floor, keep_out_mm: float, count: int) -> tuple[Floats, float]:
    """Return a square grid with at least so many places outside of the keep-out radius, and its spacing.

    Places inside that radius are part of the grid too, so that a picture shows them; they are not counted. A floor
    that lies inside it as good as wholly gets a grid of millimetres at the finest.

    Args:
        keep_out_mm: radius about the J1 axis that is kept free.
        count: wanted number of places outside.

    Returns:
        Places in whole millimetres, shape (m, 2), and the spacing, mm.

    Raises:
        ArgumentError: no place is wanted, or the keep-out radius is negative.
    """
    require_count(count, "count")
    require_not_negative(keep_out_mm, "keep_out_mm")
    spacing = float(max(np.ptp(floor.x_mm), np.ptp(floor.y_mm), 1.0))
    places = _lattice(floor, spacing)
    while np.sum(np.hypot(*places.T) >= keep_out_mm) < count and spacing > 1.0 and len(places) < 50 * count:
        spacing = max(_FINER * spacing, 1.0)
        places = _lattice(floor, spacing)
    return places, spacing


_FINER = 0.98
"""Share by which the spacing shrinks in the search for the right one."""


def _lattice(floor: Floor, spacing_mm: float) -> Floats:
    x, y = (_axis(ends, spacing_mm) for ends in (floor.x_mm, floor.y_mm))
    places = np.round(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2))
    return np.asarray(places[floor.holds(places)], dtype=np.float64)


def _axis(ends_mm: tuple[float, float], spacing_mm: float) -> Floats:
    """Return places along an axis, symmetric about its middle."""
    low, high = ends_mm
    count = int((high - low) / spacing_mm) + 1
    return np.asarray(0.5 * (low + high) + spacing_mm * (np.arange(count) - 0.5 * (count - 1)))


def apart(places_mm: Floats, apart_mm: float) -> Bools:
    """Return which pairs of places keep their distance, shape (m, m)."""
    between = np.hypot(*np.moveaxis(places_mm[:, None, :] - places_mm[None, :, :], -1, 0))
    return np.asarray(between >= apart_mm)
