"""What changed over a measurement, as the distances show it: the zero drifted, the links grew."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.drift_process import courses
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.known_sources import contributors_asked, known_sources, place_of


@dataclass(frozen=True)
class FoundDrift:
    """A contributor that changes with time, as likely as the distances and the budget make it.

    Attributes:
        contributor: with the spectrum that the distances have shown.
        change: from the beginning to the end; mm, or a share for scale and links.
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
    return FoundDrift(
        contributor,
        float(change @ mean),
        float(np.sqrt(change @ covariance @ change)),
        rms,
        float(np.sqrt(slope @ covariance @ slope)),
        1.0 if test is None else test.probability,
    )
