"""Sign and scale of a counter, from its first distances: the arm's own geometry says how lengths change."""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.plausibility.bounded_fit import fitted
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.case import Case
from catseye.calibration.scara.plausibility.corrections import scale_of
from catseye.calibration.scara.points import Points

_BOUNDS: Final = Bounds(deviation_rad=math.radians(0.5), link_mm=1.0)
"""What is known of an arm before it is measured."""

_SIGMA_MM: Final = 0.3
"""What deviations of single angles do to a distance."""

SCALE_BOUND: Final = 0.02
"""Links and places of an arm let a sound counter seem off by less."""

_COVERAGE: Final = 4.0

_POWER: Final = 2.0
"""So many standard uncertainties beyond the limit a wrong scale is recognised in 98 of 100 cases."""

_FEWEST: Final = 3
"""Distances that show anything."""


@dataclass(frozen=True)
class CounterScale:
    """What a count is worth.

    Attributes:
        mm_per_unit: of a displacement; negative where it falls while the beam grows longer.
        u: standard uncertainty.
    """

    mm_per_unit: float
    u: float

    @property
    def wrong(self) -> bool:
        """It is beyond doubt that the count is not in mm, or falls where it should rise."""
        return abs(self.mm_per_unit - 1.0) > SCALE_BOUND + _COVERAGE * self.u

    def shows(self, off: float) -> bool:
        """Return whether a counter that is off by a share would be called wrong, as good as always."""
        return SCALE_BOUND + (_COVERAGE + _POWER) * self.u < off


def counter_scale(
    points: Points, links_mm: tuple[float, float], places_mm: Floats, u_place_mm: float
) -> CounterScale | None:
    """Return what the counts of the first distances are worth; None while they do not show it.

    Args:
        points: distances; those of one dead path show it only together.
        links_mm: nominal lengths.
        places_mm: places of points.reflector_names, shape (reflectors, 2).
        u_place_mm: standard uncertainty of their coordinates.
    """
    none = np.zeros(0)
    case = Case(points, (none, none), links_mm, places_mm, "scale")
    about = scale_of(case)
    if len(points) < _FEWEST or math.isnan(about):
        return None
    scaled = replace(
        points,
        displacement_mm=about * points.displacement_mm,
        sigma_mm=np.full(len(points), _SIGMA_MM),
    )
    fit = fitted(replace(case, points=scaled), replace(_BOUNDS, place_mm=u_place_mm))
    return None if fit is None else CounterScale(about * fit.scale, abs(about) * fit.u_scale)
