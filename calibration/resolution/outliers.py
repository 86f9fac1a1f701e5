"""Single samples far off those around them: glitches of a counter or its link, which are no motion of a joint."""

from typing import Final

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints

_HALF_S: Final = 0.05
_FEWEST: Final = 5
"""Time, and samples at least, on either side that a sample is compared with; as many bad ones in a row are found."""

_MOST: Final = 50
"""Neighbours on either side, evenly spread over the time, that tell median and spread well enough: of more, some."""

_BLOCK: Final = 1 << 21
"""Neighbours of all samples that are looked at together: what bounds the memory."""

_FAR_LOCAL: Final = 10.0
"""Standard deviations of the neighbours: the peak of a smooth swing lies within one."""

_FAR: Final = 20.0
"""Standard deviations of the noise of the whole recording, or counts where that is less than one."""

_ROUNDING: Final = 1e-12
_NORMAL_MAD: Final = 1.4826


def outliers(position: Floats, quantum: float, rate_hz: float) -> Floats:
    """Return how far off its neighbours' median each outlier lies (Hampel's criterion), 0 elsewhere, shape (n,).

    Where the position only grows or only falls, a sample is the median of its neighbours: motion is no outlier.

    Args:
        position: shape (n,).
        quantum: step of the counter; 0 where readings show none.
        rate_hz: samples a second.
    """
    off, half = np.zeros(position.size), max(_FEWEST, round(min(_HALF_S * rate_hz, position.size)))
    changes = np.abs(np.diff(position))
    if position.size <= 2 * half or not changes.any():
        return off
    # A signal that stands for most of the time is no quieter for it.
    noise = _NORMAL_MAD * float(np.median(changes[changes > 0.0])) / np.sqrt(2.0)
    least = _FAR * max(noise, quantum, _ROUNDING * float(np.abs(position).max()))
    near, around = _near(changes > least, half), _neighbours(half)
    size = _BLOCK // around.size
    for part in np.split(near, range(size, near.size, size)):
        off[part] = _off(position, part, around, least)
    return off


def _neighbours(half: int) -> Ints:
    """Return where the samples lie that one is compared with, itself among them."""
    stride = max(1, half // _MOST)
    count = half // stride
    return stride * np.arange(-count, count + 1)


def _off(position: Floats, samples: Ints, around: Ints, least: float) -> Floats:
    # Mirrored at the ends: repeated, the sample there would be its own median.
    last = position.size - 1
    values = position[last - np.abs(last - np.abs(samples[:, None] + around))]
    middle = np.median(values, axis=1)
    spread = _NORMAL_MAD * np.median(np.abs(values - middle[:, None]), axis=1)
    off = position[samples] - middle
    return np.where(np.abs(off) > np.maximum(_FAR_LOCAL * spread, least), off, 0.0)


def _near(jumps: Bools, half: int) -> Ints:
    """Return the samples that a jump to the next one lies near: others are no outliers."""
    ends = np.zeros(jumps.size + half + 2, dtype=np.int64)
    at = np.flatnonzero(jumps)
    np.add.at(ends, np.maximum(at + 1 - half, 0), 1)
    np.add.at(ends, np.minimum(at + 1 + half, ends.size - 1), -1)
    return np.flatnonzero(np.cumsum(ends)[: jumps.size + 1])
