"""How fast a distance drifts while a bench warms up, and when it will have settled."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats

TEN_MINUTES_S = 600.0

FEWEST_VISITS = 4
"""Fewer visits leave no degrees of freedom worth the name to a straight line."""


_TIME_CONSTANTS = 60


@dataclass(frozen=True)
class DriftRate:
    """Slope of a distance over time.

    Attributes:
        um_per_10min: slope, µm in ten minutes.
        u_um_per_10min: its standard uncertainty, from the scatter about the line.
        visits: how many distances it comes from.
    """

    um_per_10min: float
    u_um_per_10min: float
    visits: int

    @property
    def bound_um_per_10min(self) -> float:
        """What the drift is at most, one standard uncertainty included."""
        return abs(self.um_per_10min) + self.u_um_per_10min


@dataclass(frozen=True)
class Settling:
    """A distance that approaches its end exponentially.

    Attributes:
        amplitude_mm: what is still to come at time 0.
    """

    time_constant_s: float
    amplitude_mm: float

    def below_after_s(self, limit_um_per_10min: float) -> float:
        """Return the time after which the drift is below a limit, s; 0 when it always is."""
        at_start = abs(self.amplitude_mm) * 1e3 * TEN_MINUTES_S / self.time_constant_s
        return max(0.0, self.time_constant_s * math.log(max(at_start / limit_um_per_10min, 1e-300)))


def drift_rate(time_s: Floats, length_mm: Floats) -> DriftRate | None:
    """Return the drift of a distance; None for fewer than 4 visits, or visits that are all at one time.

    Args:
        time_s: times of the visits, s, shape (n,).
        length_mm: distances that share a zero, mm, shape (n,).
    """
    _require_visits(time_s, length_mm)
    if time_s.size < FEWEST_VISITS or np.ptp(time_s) <= 0.0:
        return None
    from_mean = time_s - time_s.mean()
    square = float(from_mean @ from_mean)
    slope = float(from_mean @ length_mm) / square
    left = length_mm - length_mm.mean() - slope * from_mean
    u_slope = math.sqrt(float(left @ left) / (time_s.size - 2) / square)
    scale = 1e3 * TEN_MINUTES_S
    return DriftRate(slope * scale, u_slope * scale, int(time_s.size))


def settling(time_s: Floats, length_mm: Floats) -> Settling | None:
    """Fit an exponential approach.

    Args:
        time_s: times of the visits, s, shape (n,).
        length_mm: distances that share a zero, mm, shape (n,).

    Returns:
        None while the distances do not separate an exponential from a straight line.
    """
    # Whoever only lists procedures imports this module too.
    from scipy import special

    _require_visits(time_s, length_mm)
    if time_s.size < FEWEST_VISITS + 2 or np.ptp(time_s) <= 0.0:
        return None
    span = float(np.ptp(time_s))
    since = time_s - time_s.min()
    trials = np.geomspace(0.1 * span, 3.0 * span, _TIME_CONSTANTS)
    amplitudes, squares = _exponentials(since, length_mm, trials)
    best = int(np.argmin(squares))
    if best in (0, trials.size - 1):
        return None
    straight = np.polynomial.polynomial.polyfit(since, length_mm, 1, full=True)[1][0]
    dof = time_s.size - 3
    scatter = float(squares[best]) / dof
    gain = max(float(np.ravel(straight)[0]) - float(squares[best]), 0.0)
    if special.fdtrc(1, dof, gain / max(scatter, 1e-30)) > SIGNIFICANCE:
        return None
    tau = float(trials[best])
    # The amplitude belongs to the first visit; time 0 may lie before it.
    return Settling(tau, float(amplitudes[best]) * math.exp(float(time_s.min()) / tau))


def _require_visits(time_s: Floats, length_mm: Floats) -> None:
    require_shape(length_mm, time_s.shape, "length_mm")
    require_finite(time_s, "time_s")
    require_finite(length_mm, "length_mm")


def _exponentials(since_s: Floats, length_mm: Floats, time_constants_s: Floats) -> tuple[Floats, Floats]:
    """Return, for each time constant, the amplitude at the first visit and the sum of squares of what is left."""
    decay = np.exp(-since_s / time_constants_s[:, None])
    decay -= decay.mean(axis=1, keepdims=True)
    from_mean = length_mm - length_mm.mean()
    amplitudes = decay @ from_mean / np.sum(decay**2, axis=1)
    left = from_mean - amplitudes[:, None] * decay
    return np.asarray(amplitudes), np.asarray(np.sum(left**2, axis=1))
