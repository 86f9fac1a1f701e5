"""When the motions of a recording begin, against the times at which they were commanded."""

import math

import numpy as np

from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.speed import speed_of

_BEGUN = 0.02
"""Share of its largest velocity from which on the common motion counts as begun."""

_NOISE = 5.0
"""Or so many standard deviations of its noise, where those are more."""

EARLY_S = 0.05
"""The smoothing shows a motion that begins slowly so much too early, an abrupt one by almost half its window."""

_NORMAL_QUARTER = 0.3186
"""A quarter of normally distributed numbers lie within so many standard deviations."""


def motion_begin_s(recording: Recording, moves: Moves) -> float:
    """Return when the motions begin after given times, s: negative where those lie within motion, NaN without any.

    It is taken from the mean of all motions, each as a share of its command: single small ones drown in the noise.
    """
    speed, half = speed_of(recording), round(0.5 * moves.dwell_s * recording.rate_hz)
    total, weight = np.zeros(2 * half), np.zeros(2 * half)
    for at_s, command in zip(moves.time_s.tolist(), moves.command.tolist(), strict=True):
        first = recording.index(at_s) - half
        if first < 0 or first + 2 * half > speed.size:
            continue
        window = speed[first : first + 2 * half]
        total += np.nan_to_num(command * window)
        weight += np.where(np.isnan(window), 0.0, command * command)
    mean = total / np.maximum(weight, np.finfo(float).tiny)
    fastest = int(np.argmax(mean))
    # A motion may take more than half of the dwell, a quarter of it is always rest.
    noise = float(np.quantile(np.abs(mean), 0.25)) / _NORMAL_QUARTER
    limit = max(_BEGUN * mean[fastest], _NOISE * noise)
    if mean[fastest] < limit:
        return math.nan
    slower = np.flatnonzero(mean[:fastest] < limit)
    begun = int(slower[-1]) + 1 if slower.size else fastest
    # A velocity belongs to the middle between its two samples.
    return (begun + 0.5 - half) / recording.rate_hz + EARLY_S
