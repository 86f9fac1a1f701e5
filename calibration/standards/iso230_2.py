"""Positioning of an axis after ISO 230-2: quantities of repeated bidirectional approaches, or of a joint's map.

Deviations are actual minus target; up and down are the approaches towards larger and smaller positions. Values come
in the unit of the deviations.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_count, require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats

NAMES = {
    "B": "reversal error",
    "B̄": "mean reversal error",
    "E": "bidirectional systematic error",
    "E↑": "unidirectional systematic error, upwards",
    "E↓": "unidirectional systematic error, downwards",
    "M": "mean bidirectional error",
    "R": "bidirectional repeatability",
    "R↑": "unidirectional repeatability, upwards",
    "R↓": "unidirectional repeatability, downwards",
    "A": "bidirectional accuracy",
    "A↑": "unidirectional accuracy, upwards",
    "A↓": "unidirectional accuracy, downwards",
}
"""What the standard calls its quantities."""

SYSTEMATIC = ("B", "B̄", "E", "E↑", "E↓", "M")
"""Quantities that mean deviations determine, without any repeats."""


@dataclass(frozen=True)
class Positioning:
    """Quantities of an axis from repeated approaches.

    Attributes:
        mean_up: mean unidirectional positioning error upwards, shape (m,).
        mean_down: the same downwards, shape (m,).
        s_up: estimator of unidirectional repeatability upwards, shape (m,).
        s_down: the same downwards, shape (m,).
        reversal: reversal error at each target, upwards minus downwards, shape (m,).
        repeatability: bidirectional repeatability at each target, shape (m,).
        quantities: of the axis by symbol, see NAMES.
    """

    mean_up: Floats
    mean_down: Floats
    s_up: Floats
    s_down: Floats
    reversal: Floats
    repeatability: Floats
    quantities: dict[str, float]


def positioning(up: Floats, down: Floats) -> Positioning:
    """Return the quantities of n approaches to each of m targets from both sides.

    Args:
        up: deviations approached upwards, shape (m, n), n >= 2.
        down: deviations approached downwards, shape (m, n).

    Raises:
        InsufficientPointsError: a target has fewer than two approaches from a side.
        ArgumentError: the sides have different targets, or a deviation is not finite.
    """
    for name, side in (("up", up), ("down", down)):
        require_shape(side, (len(up), None), name)
        require_finite(side, name)
    if min(up.shape[1], down.shape[1]) < 2:
        raise InsufficientPointsError(
            "repeatability needs two approaches or more to each target from each side; the standard test has five"
        )
    spreads = up.std(axis=1, ddof=1), down.std(axis=1, ddof=1)
    return with_repeatability(up.mean(axis=1), down.mean(axis=1), *spreads)


def with_repeatability(mean_up: Floats, mean_down: Floats, s_up: Floats, s_down: Floats) -> Positioning:
    """Return the quantities from means and standard deviations at m targets, shape (m,) each."""
    reversal = mean_up - mean_down
    both = np.maximum(2.0 * s_up + 2.0 * s_down + np.abs(reversal), 4.0 * np.maximum(s_up, s_down))
    high_up, low_up = mean_up + 2.0 * s_up, mean_up - 2.0 * s_up
    high_down, low_down = mean_down + 2.0 * s_down, mean_down - 2.0 * s_down
    quantities = dict(zip(SYSTEMATIC, systematic(mean_up, mean_down).tolist(), strict=True))
    quantities |= {
        "R": float(both.max()),
        "R↑": float(4.0 * s_up.max()),
        "R↓": float(4.0 * s_down.max()),
        "A": float(max(high_up.max(), high_down.max()) - min(low_up.min(), low_down.min())),
        "A↑": float(high_up.max() - low_up.min()),
        "A↓": float(high_down.max() - low_down.min()),
    }
    return Positioning(mean_up, mean_down, s_up, s_down, reversal, both, quantities)


def systematic(mean_up: Floats, mean_down: Floats) -> Floats:
    """Return the quantities named in SYSTEMATIC.

    Args:
        mean_up: mean deviations upwards, shape (..., m).
        mean_down: mean deviations downwards, shape (..., m).

    Returns:
        Values in the order of SYSTEMATIC, shape (..., 6).
    """
    reversal = mean_up - mean_down
    either = np.concatenate([mean_up, mean_down], axis=-1)
    return np.stack(
        [
            np.abs(reversal).max(axis=-1),
            reversal.mean(axis=-1),
            np.ptp(either, axis=-1),
            np.ptp(mean_up, axis=-1),
            np.ptp(mean_down, axis=-1),
            np.ptp(0.5 * (mean_up + mean_down), axis=-1),
        ],
        axis=-1,
    )


@dataclass(frozen=True)
class Uncertain:
    """A quantity with what is known about it.

    Attributes:
        symbol: see NAMES.
        value: of the estimates as they are.
        u: standard uncertainty.
        excess: what a value from noisy estimates exceeds the true one by on average: a largest difference grows with
            noise. It is not taken off.
    """

    symbol: str
    value: float
    u: float
    excess: float

    @property
    def name(self) -> str:
        """What the standard calls it."""
        return NAMES[self.symbol]


def systematic_of_map(
    mean: Floats, covariance: Floats, draws: int = 20_000, seed: int = 1
) -> tuple[Uncertain, ...]:
    """Return the systematic quantities of a joint's map with their uncertainties.

    A largest difference cannot be differentiated where two targets compete, so draws of the map propagate its
    covariance; their mean shows how much noise adds to such a quantity.

    Args:
        mean: the map at m nodes, upwards, then downwards, shape (2m,).
        covariance: of the map, shape (2m, 2m); it may be singular.

    Raises:
        ArgumentError: the covariance does not belong to the map, or there are fewer than two draws.
    """
    require_shape(mean, (2 * (np.size(mean) // 2),), "mean")
    require_shape(covariance, (mean.size, mean.size), "covariance")
    require_count(draws, "draws", 2)
    require_count(seed, "seed", 0)
    half = mean.size // 2
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    drawn = mean + np.random.default_rng(seed).standard_normal((draws, mean.size)) @ root.T
    scattered = systematic(drawn[:, :half], drawn[:, half:])
    found = systematic(mean[:half], mean[half:])
    return tuple(
        Uncertain(symbol, float(value), float(one.std()), float(one.mean() - value))
        for symbol, value, one in zip(SYSTEMATIC, found, scattered.T, strict=True)
    )
