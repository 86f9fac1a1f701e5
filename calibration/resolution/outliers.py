"""Single samples far off those around them: glitches of a counter or its link, which are no motion of a joint."""

from typing import Final

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints

_HALF: Final = 5
"""Neighbours on either side that a sample is compared with; as many bad ones in a row are found."""

_FAR_LOCAL: Final = 10.0
"""Standard deviations of the neighbours: the peak of a smooth swing lies within one."""

_FAR: Final = 20.0
"""Standard deviations of the noise of the whole recording, or counts where that is less than one."""

_ROUNDING: Final = 1e-12
_NORMAL_MAD: Final = 1.4826


def outliers(position: Floats, quantum: float) -> Floats:
    """Return how far off its neighbours' median each outlier lies (Hampel's criterion), 0 elsewhere, shape (n,).

    Where the position only grows or only falls, a sample is the median of its neighbours: motion is no outlier.

    Args:
        position: shape (n,).
        quantum: step of the counter; 0 where readings show none.
    """
    off = np.zeros(position.size)
    if position.size <= 2 * _HALF:
        return off
    changes = np.abs(np.diff(position))
    # A signal that stands for most of the time is no quieter for it.
    noise = _NORMAL_MAD * float(np.median(changes[changes > 0.0])) / np.sqrt(2.0) if changes.any() else 0.0
    least = _FAR * max(noise, quantum, _ROUNDING * float(np.abs(position).max()))
    near = _near(changes > least)
    around = np.clip(near[:, None] + np.arange(-_HALF, _HALF + 1), 0, position.size - 1)
    values = position[around]
    middle = np.median(values, axis=1)
    spread = _NORMAL_MAD * np.median(np.abs(values - middle[:, None]), axis=1)
    from_middle = position[near] - middle
    off[near] = np.where(np.abs(from_middle) > np.maximum(_FAR_LOCAL * spread, least), from_middle, 0.0)
    return off


def _near(jumps: Bools) -> Ints:
    """Return the samples that a jump to the next one lies near: others are no outliers."""
    places = np.flatnonzero(jumps)
    return np.unique((places[:, None] + np.arange(1 - _HALF, _HALF + 1)).clip(0, jumps.size))
