"""The drift of a standstill, beside what still settles in it.

A joint that has come to rest creeps on for some seconds the way that it moved, ever more slowly. A line through a
short standstill takes that for a drift, which it is not: it has ended when the steps begin, and what creeps behind
each step is part of the step. So the drift is the slope of a line beside a settling, c exp(−t/τ), of any size. The
time constant is not known: all are averaged over, as likely as the standstill makes them (Hoeting et al., Bayesian
model averaging, Statistical Science 14 (1999) 382).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats

_BLOCKS: Final = 12
"""Means that are fitted to: few enough to be nearly independent, more than a line and a settling need."""

_SETTLING_S: Final = (1.0, 2.0, 4.0, 8.0)
"""Time constants of a settling: faster ones have ended when a joint counts as resting."""

DOF: Final = _BLOCKS - 3

_MOST_ALIKE: Final = 0.8
"""Correlation of neighbouring means: a dozen of them cannot show a larger one."""

_TINY: Final = 1e-300


@dataclass(frozen=True)
class SettledDrift:
    """Drift of a position that should not change.

    Attributes:
        per_s: units a second.
        u_per_s: its standard uncertainty, from the scatter of means over a twelfth of the time and from what is not
            known of the settling.
        expected: where the samples would be without noise, shape (n,).
    """

    per_s: float
    u_per_s: float
    expected: Floats


@dataclass(frozen=True)
class _Fit:
    """A line and a settling of one time constant.

    Attributes:
        share: the time constant.
        values: level, slope over the whole standstill, and settling, shape (3,).
        u_slope: standard uncertainty of the slope; neighbouring means may be alike.
        square: sum of squares that is left.
    """

    share: float
    values: Floats
    u_slope: float
    square: float


def settled_drift(position: Floats, rate_hz: float) -> SettledDrift:
    """Return the drift of positions at uniform times, shape (n,)."""
    edges = np.linspace(0, position.size, _BLOCKS + 1).astype(np.int64)
    means = np.add.reduceat(position - position[0], edges[:-1]) / np.diff(edges)
    length_s = position.size / rate_hz
    fits = [_fit(means, edges / position.size, settling_s / length_s) for settling_s in _SETTLING_S]
    squares = np.array([fit.square for fit in fits])
    weights = (squares / squares.min()) ** (-0.5 * DOF)
    weights /= weights.sum()
    slopes = np.array([fit.values[1] for fit in fits])
    slope = float(weights @ slopes)
    variance = float(weights @ (np.array([fit.u_slope for fit in fits]) ** 2 + (slopes - slope) ** 2))
    place = (np.arange(position.size) + 0.5) / position.size
    expected = position[0] + sum(
        weight * (_columns(place, fit.share) @ fit.values) for weight, fit in zip(weights, fits, strict=True)
    )
    return SettledDrift(slope / length_s, variance**0.5 / length_s, expected)


def _columns(place: Floats, share: float) -> Floats:
    return np.column_stack([np.ones(place.size), place, np.exp(-place / share)])


def _fit(means: Floats, edges: Floats, share: float) -> _Fit:
    """Return the fit to means between edges, which are shares of the standstill, shape (blocks + 1,)."""
    widths = np.diff(edges)
    columns = _columns(0.5 * (edges[1:] + edges[:-1]), share)
    columns[:, 2] = -share * np.diff(np.exp(-edges / share)) / widths
    inverse = np.linalg.inv(columns.T @ columns)
    values = inverse @ columns.T @ means
    left = means - columns @ values
    square = max(float(left @ left), _TINY)
    variance = square / DOF * inverse[1, 1] * _correlation_factor(left, square)
    return _Fit(share, values, float(np.sqrt(variance)), square)


def _correlation_factor(left: Floats, square: float) -> float:
    """Return by how much the variance grows since neighbours are alike: air shimmers slowly, and a drift bends."""
    alike = min(max(float(left[1:] @ left[:-1]) / square, 0.0), _MOST_ALIKE)
    return (1.0 + alike) / (1.0 - alike)
