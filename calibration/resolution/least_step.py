"""The rule of the resolution paper (section 3.6): moving mean of step errors, and where it leaves the threshold."""

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints

WINDOW = 11
"""Steps of the moving mean."""

_EQUAL = 1e-6
"""Sizes that differ by this share are one size."""


def first_grown(size: Floats) -> int | None:
    """Return the place, from 0, of the first step that is no smaller than the one before; None where they decrease.

    What a controller rounds may repeat a size; the step after that falls by at least what it resolves.

    Args:
        size: two or more, shape (n,).
    """
    grown = np.diff(size) > _EQUAL * size[1:]
    grown[:-1] |= size[2:] > (1.0 - _EQUAL) * size[:-2]
    grown[-1] |= size[-1] > (1.0 - _EQUAL) * size[0]
    return int(np.argmax(grown)) + 1 if grown.any() else None


def moving_mean(errors: Floats) -> Floats:
    """Return the mean over the step itself and five neighbours on either side.

    Near the ends, and where an error is NaN, it is the mean of what is there.

    Args:
        errors: by decreasing step, shape (..., steps).

    Returns:
        NaN where the window holds nothing, shape (..., steps).
    """
    there: Bools = np.isfinite(errors)
    sums, counts = _window_sums(np.where(there, errors, 0.0)), _window_sums(there.astype(np.float64))
    means: Floats = np.divide(sums, counts, out=np.full(errors.shape, np.nan), where=counts > 0.5)
    return means


def moving_spread(errors: Floats, means: Floats) -> Floats:
    """Return the standard deviation of step errors about their moving mean, in the same window.

    Args:
        errors: by decreasing step, shape (..., steps).
        means: their moving means, shape (..., steps).
    """
    return np.asarray(np.sqrt(moving_mean((errors - means) ** 2)))


def steps_within(means: Floats, threshold: float) -> Ints:
    """Return how many steps, from the largest on, keep within the threshold without a gap.

    The last of them is the least increment step. A NaN is not within.

    Args:
        means: moving means by decreasing step, in the unit of the threshold, shape (..., steps).
        threshold: largest magnitude that counts as within.
    """
    within: Bools = np.abs(means) <= threshold
    counts: Ints = np.cumprod(within, axis=-1, dtype=np.int64).sum(axis=-1)
    return counts


def _window_sums(values: Floats) -> Floats:
    half = WINDOW // 2
    edge = [(0, 0)] * (values.ndim - 1) + [(half, half)]
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, edge), WINDOW, axis=-1)
    sums: Floats = windows.sum(axis=-1)
    return sums
