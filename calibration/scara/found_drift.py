"""What changed over a measurement, as the distances show it: the zero drifted, the links grew."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.drift_process import courses
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.known_sources import contributors_asked, known_sources, place_of

_NOTHING = 1e-12
"""Share of a source's variance that distances take away where they say nothing of it: rounding."""


@dataclass(frozen=True)
class FoundDrift:
    """A contributor that changes with time, as likely as the distances and the budget make it.

    Attributes:
        contributor: with the spectrum that the distances have shown.
        change: from the first row to the last, with no expectation of how steady it is; mm, or a share for scale and
            links.
        u_change: its standard uncertainty.
        rms: over the measurement, about its mean.
        u_rms: its standard uncertainty.
        probability: of distances that show so much of it when there is none.
    """

    contributor: Contributor
    change: float
    u_change: float
    rms: float
    u_rms: float
    probability: float

    @property
    def significant(self) -> bool:
        """It was there: neither scatter nor another contributor explains it."""
        return self.probability < SIGNIFICANCE


def found_drifts(identified: Identification) -> tuple[FoundDrift, ...]:
    """Return what the contributors that change with time did, as far as distances were asked about them."""
    systematic = contributors_asked(identified)
    asked = (one for one in systematic if one.correlation == "time" and one.spectrum and one.u > 0.0)
    return tuple(_found(identified, one) for one in asked)


def _found(identified: Identification, contributor: Contributor) -> FoundDrift:
    mean, covariance = known_sources(identified, contributor)
    # As functions of time that a model with all other contributors lacks.
    test = identified.sources.test(place_of(identified, contributor))
    sizes = contributor.u * np.sqrt(contributor.shares)
    ends = courses(np.array([-0.5, 0.5]), contributor.orders) * sizes
    change = ends[1] - ends[0]
    rms = float(np.linalg.norm(sizes * mean))
    slope = sizes**2 * mean / rms if rms > 0.0 else np.zeros(mean.size)
    steady, u_steady = _as_shown(mean, covariance, identified.fit.unit_weight_variance)
    return FoundDrift(
        contributor,
        float(change @ steady),
        float(np.sqrt(change @ u_steady @ change)),
        rms,
        float(np.sqrt(slope @ covariance @ slope)),
        1.0 if test is None else test.probability,
    )


def _as_shown(mean: Floats, covariance: Floats, unit_variance: float) -> tuple[Floats, Floats]:
    """Return sources and their covariance as they are if nothing is known of the steady one, the first, beforehand.

    Distances say little of a steady drift, which the maps nearly absorb: that it is small, as the budget expects,
    would draw the change towards zero by more than its uncertainty. Dividing the prior of unit variance out is an
    update of rank one.

    Args:
        mean: conditional mean of the sources, shape (m,).
        covariance: theirs, shape (m, m).
        unit_variance: what it was widened by.
    """
    column = covariance[:, 0] / unit_variance
    left = max(1.0 - float(column[0]), _NOTHING)
    return (
        mean + column * (mean[0] / left),
        covariance + unit_variance * np.outer(column, column) / left,
    )
