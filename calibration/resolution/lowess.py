"""Locally weighted lines (LOWESS of degree 1, tricube weights, no robustness iterations) on a uniform grid.

Where as many neighbours lie on either side, the local line at its centre is a weighted mean with fixed weights: one
convolution for the whole interior. Within half a window of an end, neighbours lie on one side mostly, and every
sample takes a fit of its own. Source: W. S. Cleveland, JASA 74 (1979) 829; the resolution paper, section 3.6, whose
window is 0.5 s.
"""

import numpy as np
from scipy import signal

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats

WINDOW_S = 0.5
"""The paper's window; its "500 Hz … shorter than 2 ms" is a slip."""

_FEWEST = 2
"""Neighbours on either side that a local line needs: those farthest off have no weight."""

_BLOCK_NUMBERS = 1 << 22


def half_window(rate_hz: float, window_s: float = WINDOW_S) -> int:
    """Return how many neighbours on either side make up a window."""
    return max(_FEWEST, round(0.5 * window_s * rate_hz))


def lowess(values: Floats, half: int) -> Floats:
    """Return the local lines' values at the samples, shape (n,).

    Every sample has the 2·half + 1 nearest ones as its neighbourhood, the farthest of which have no weight.

    Args:
        values: on a uniform grid, shape (n,).
        half: neighbours on either side in the interior.

    Raises:
        InsufficientPointsError: there are fewer samples than a neighbourhood has.
    """
    width = 2 * half + 1
    if values.size < width:
        raise InsufficientPointsError(
            f"{values.size} samples are fewer than the {width} of a window: record longer, or shorten the window"
        )
    # The lines reproduce a constant; without it, rounding is that of the signal's changes.
    level = float(values.mean())
    centred = values - level
    weights = _tricube(np.arange(-half, half + 1) / half)
    smooth = np.empty(values.size)
    smooth[half : values.size - half] = signal.oaconvolve(centred, weights / weights.sum(), mode="valid")
    smooth[:half] = _at_start(centred[:width], half)
    smooth[values.size - half :] = _at_start(centred[: -width - 1 : -1], half)[::-1]
    return smooth + level


def velocity(position: Floats, rate_hz: float, window_s: float = WINDOW_S) -> Floats:
    """Return the smoothed velocity between successive samples, in units of the position a second, shape (n − 1,).

    Args:
        position: shape (n,).
        rate_hz: samples a second.
    """
    return lowess(np.diff(position) * rate_hz, half_window(rate_hz, window_s))


def _tricube(share: Floats) -> Floats:
    return np.asarray((1.0 - np.minimum(np.abs(share), 1.0) ** 3) ** 3, dtype=np.float64)


def _at_start(first: Floats, half: int) -> Floats:
    """Return the local lines at the first samples, whose neighbourhood is that of the sample in its middle."""
    places = np.arange(first.size, dtype=np.float64)
    rows = max(1, _BLOCK_NUMBERS // first.size)
    return np.concatenate(
        [
            _local_lines(places, first, np.arange(start, min(start + rows, half), dtype=np.float64))
            for start in range(0, half, rows)
        ]
    )


def _local_lines(places: Floats, values: Floats, centres: Floats) -> Floats:
    away = places - centres[:, None]
    weights = _tricube(away / np.abs(away).max(axis=1, keepdims=True))
    total = weights.sum(axis=1)
    mean_place = np.sum(weights * away, axis=1) / total
    from_mean = away - mean_place[:, None]
    slope = np.sum(weights * from_mean * values, axis=1) / np.sum(weights * from_mean**2, axis=1)
    return np.asarray(weights @ values / total - slope * mean_place)
