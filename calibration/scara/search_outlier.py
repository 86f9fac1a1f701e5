"""A sighting that does not belong to the others: another reflector or a reflection was caught."""

from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.arguments import require_not_negative
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.reflector_search import SearchResult, Sightings, locate_reflectors

_FALSE_ALARM = 0.001
"""Probability of a false alarm in a search without an outlier."""

_LEAST_FREEDOM = 2
"""Degrees of freedom that the others need to judge one."""

_SUSPECTS = 4
"""So many of the largest residuals are judged."""


@dataclass(frozen=True)
class Outlier:
    """A sighting that the others contradict.

    Attributes:
        row: which sighting.
        off_rad: aim found minus the aim that the others predict, -π…π.
        off_mm: the same as a miss at the reflector.
        ratio: the same in standard uncertainties of that difference.
    """

    row: int
    off_rad: float
    off_mm: float
    ratio: float


def find_outlier(
    sightings: Sightings,
    found: SearchResult,
    link1_mm: float,
    link2_mm: float,
    least_mm: float,
) -> Outlier | None:
    """Return the sighting that contradicts the others most, if one does beyond doubt.

    Each suspect is predicted from a solution without it and compared in units of the difference's uncertainty
    (Student's t, with the chance of a false alarm shared among all sightings).

    Args:
        found: solution from all of them.
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        least_mm: differences that miss the reflector's centre by less are no outliers.

    Raises:
        ArgumentError: least_mm is negative or no number.
    """
    require_not_negative(least_mm, "least_mm")
    count = sightings.j4_rad.size
    freedom = count - 1 - found.covariance.shape[0]
    if freedom < _LEAST_FREEDOM:
        return None
    xy_mm = forward(sightings.theta1_rad, sightings.theta2_rad, link1_mm, link2_mm)
    limit = float(special.stdtrit(freedom, 1.0 - 0.5 * _FALSE_ALARM / count))
    suspects = np.argsort(-np.abs(found.residuals_rad))[:_SUSPECTS]
    judged = [_judged(sightings, found, int(row), xy_mm, (link1_mm, link2_mm)) for row in suspects]
    clear = [one for one in judged if one is not None and one.ratio > limit and abs(one.off_mm) > least_mm]
    return max(clear, key=lambda one: one.ratio, default=None)


def _judged(
    sightings: Sightings, found: SearchResult, row: int, xy_mm: Floats, links_mm: tuple[float, float]
) -> Outlier | None:
    others = np.arange(sightings.j4_rad.size) != row
    try:
        without = locate_reflectors(
            sightings.select(others), *links_mm, found.reflectors_mm, found.theta40_rad
        )
    except CalibrationError:
        # The others do not determine the unknowns without this one.
        return None
    which = int(sightings.reflector[row])
    seen = sightings.theta1_rad[row] + sightings.theta2_rad[row] + sightings.j4_rad[row]
    off = float(wrap_rad(np.array([seen - without.predicted_rad(xy_mm[row], which)]))[0])
    length = float(np.hypot(*(without.reflectors_mm[which] - xy_mm[row])))
    u = without.u_prediction_rad(xy_mm[row], which)
    return Outlier(row, off, off * length, abs(off) / u if u > 0.0 else np.inf)
