"""How fast the position of a recording changes, where that is known."""

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.lowess import half_window, velocity
from catseye.calibration.resolution.recording import Recording

_HIDING_S = 0.1
"""A gap longer than this may hide where a motion begins and ends; across a shorter one it is seen."""


def speed_of(recording: Recording) -> Floats:
    """Return the smoothed velocity between successive samples, in units of the position a second, shape (n − 1,).

    Within half a window of a gap that may hide a motion it is NaN: between its ends, any motion is invented. So it is
    within half a window of the recording's ends, where a velocity takes its noise from single samples: that is up to
    hundred times the noise elsewhere, and would pass for motion.
    """
    speed = velocity(recording.position, recording.rate_hz)
    reach = half_window(recording.rate_hz)
    speed[:reach] = speed[-reach:] = np.nan
    if recording.missing is not None:
        speed[_hidden(recording.missing, recording.rate_hz)] = np.nan
    return speed


def _hidden(missing: Bools, rate_hz: float) -> Bools:
    """Return which intervals between samples lie in or near long gaps, shape (n − 1,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]])))
    hidden = np.zeros(missing.size - 1, dtype=np.bool_)
    reach = half_window(rate_hz)
    for first, end in edges.reshape(-1, 2).tolist():
        if end - first > _HIDING_S * rate_hz:
            hidden[max(first - 1 - reach, 0) : end + reach] = True
    return hidden
