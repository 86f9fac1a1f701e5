"""What the recording does while the arm stands still: noise at every averaging time, and drift.

The noise of an interferometer in air is not white: the mean of a plateau is not as good as σ/√n says. So means are
compared with means, as the Allan deviation does, over as long a time as plateaus have and as far apart as they are.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.significance import Judged
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.settled_drift import DOF, settled_drift

SHORTEST_S = 10.0
"""A standstill shorter than this says little about plateaus some seconds apart."""


@dataclass(frozen=True)
class Standstill(Judged):
    """Noise and drift of a position that should not change.

    Attributes:
        rate_hz: samples a second.
        noise: samples without drift and settling, shape (n,).
        sigma: standard deviation of the noise, in units of the position.
        drift_per_s: slope beside a settling, units a second.
        u_drift_per_s: its standard uncertainty.
        probability: of a slope this steep without any drift.
    """

    rate_hz: float
    noise: Floats
    sigma: float
    drift_per_s: float
    u_drift_per_s: float
    probability: float

    def u_of_step(self, mean_s: float, apart_s: float) -> float:
        """Return the standard uncertainty of the difference of two means of the position.

        It is the rms of all such differences in the standstill: a structure function of means, √2 times the Allan
        deviation where the means adjoin.

        Args:
            mean_s: time that a mean is taken over, s.
            apart_s: from the begin of one to the begin of the other, s; the standstill may shorten it.
        """
        samples = max(1, round(mean_s * self.rate_hz))
        samples = min(samples, self.noise.size // 4)
        means = _running_means(self.noise, samples)
        apart = min(max(samples, round(apart_s * self.rate_hz)), means.size // 2)
        return float(np.sqrt(np.mean((means[apart:] - means[:-apart]) ** 2)))


def standstill(recording: Recording) -> Standstill:
    """Return noise and drift of a recording in which nothing is to move.

    Raises:
        RecordingError: it is shorter than 10 s.
    """
    # Whoever only lists procedures imports this module too.
    from scipy import special

    position, rate_hz = recording.position, recording.rate_hz
    if position.size < SHORTEST_S * rate_hz:
        raise RecordingError(
            f"the standstill lasts {position.size / rate_hz:.3g} s: noise and drift need {SHORTEST_S:g} s or more; "
            "record 60 s before the first move"
        )
    drift = settled_drift(position, recording.rate_hz)
    noise = position - drift.expected
    t = abs(drift.per_s) / max(drift.u_per_s, 1e-300)
    probability = 2.0 * float(special.stdtr(DOF, -t))
    return Standstill(rate_hz, noise, float(noise.std()), drift.per_s, drift.u_per_s, probability)


def _running_means(values: Floats, samples: int) -> Floats:
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[samples:] - sums[:-samples]) / samples)
