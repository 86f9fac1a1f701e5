"""The times of samples: their rate, the uniform grid they belong to, and what is missing on it."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.flags import Flag

LEAST_RATE_HZ = 20.0
"""Below it, a window of 0.5 s has too few samples for a local line."""

NEARLY = 0.97
"""Share of the least rate that counts as reached: clocks differ, and single samples come late."""

_MOST_RATE_HZ = 1e6
_GAP = 1.5
"""An interval this many times the usual one lacks a sample."""

_IRREGULAR = 0.05
"""Deviation from the uniform grid, rms, in intervals, from which sampling is flagged."""

_MOST_MISSING = 0.5
"""Share of the grid without samples from which on it is no recording of a test."""

_PARTS = 10
_FEWEST_IN_PART = 10
_STEADY = 0.1
"""Largest relative change of the usual interval from part to part of a recording at one rate."""

_SAME_RATE = 0.01
"""A rate that somebody states is rounded, and clocks differ by less."""


@dataclass(frozen=True)
class Grid:
    """Positions at uniform times.

    Attributes:
        interval_s: from one to the next, s.
        position: interpolated where none was recorded, shape (n,).
        missing: where none was recorded, shape (n,); None where nothing is missing.
        flags: how the times differed from those of the grid.
    """

    interval_s: float
    position: Floats
    missing: Bools | None
    flags: tuple[Flag, ...]


def gridded(time_s: Floats, position: Floats, good: Bools) -> Grid:
    """Put samples on the uniform grid of their times.

    Samples stay what they are where they lie on the grid, missing ones left out. Where they do not, for a counter
    that was asked late or a rate that wanders, the grid's values are interpolated between neighbours.

    Args:
        time_s: finite, s, shape (n,), two or more.
        position: shape (n,).
        good: which samples count; the others are as good as missing, shape (n,).

    Raises:
        RecordingError: times do not increase, the rate cannot be that of a recording, or most samples are missing.
    """
    steps = np.diff(time_s)
    usual_s = _usual_interval(time_s, steps)
    gaps = np.flatnonzero(steps > _GAP * usual_s)
    number = np.concatenate(
        [[0.0], np.cumsum(np.round(steps / usual_s) if gaps.size else np.ones(steps.size))]
    )
    span_s = float(time_s[-1] - time_s[0])
    interval_s = span_s / float(number[-1])
    off = (time_s - time_s[0]) / interval_s - number
    off -= np.median(off)
    on_grid = bool(np.all(np.diff(number) > 0)) and float(np.abs(off).max()) < 1.0
    if on_grid and not gaps.size and good.all():
        return Grid(interval_s, position, None, tuple(_irregular(off)))
    if not on_grid:
        number = (time_s - time_s[0]) / usual_s
        interval_s = span_s / round(number[-1])
        number = (time_s - time_s[0]) / interval_s
    places = np.arange(round(float(number[-1])) + 1, dtype=np.float64)
    _require_most(time_s, steps, places.size)
    flags = (*_irregular(off), *_gap_flags(time_s, steps, int(_missing(number, places).sum())))
    number = number[good]
    return Grid(interval_s, np.interp(places, number, position[good]), _missing(number, places), flags)


def require_steady_rate(time_s: Floats) -> None:
    """Refuse the times of a file whose rate changes: nobody knows which of them are right.

    Args:
        time_s: increasing, s, shape (n,).

    Raises:
        RecordingError: the text names the sample and what to do.
    """
    steps = np.diff(time_s)
    if steps.size < _PARTS * _FEWEST_IN_PART:
        return
    usual_s, first = float(np.median(steps)), 0
    for part in np.array_split(steps, _PARTS):
        interval_s = float(np.median(part))
        if abs(interval_s / usual_s - 1.0) > _STEADY:
            raise RecordingError(
                f"sample {first + 1}: from about here, samples are {interval_s:.4g} s apart, {usual_s:.4g} s in most "
                "of the recording: the rate is not uniform; record at a fixed rate, or resample the file and say so",
                first + 1,
            )
        first += part.size


def require_stated_rate(time_s: Floats, rate_hz: float) -> None:
    """Refuse times that contradict the rate that somebody states.

    Args:
        time_s: increasing, s, shape (n,), two or more.
        rate_hz: as stated, samples a second.

    Raises:
        RecordingError: the text names both.
    """
    found_hz = 1.0 / float(np.median(np.diff(time_s)))
    if abs(found_hz / rate_hz - 1.0) > _SAME_RATE:
        raise RecordingError(
            f"the times give {found_hz:.4g} samples a second, {rate_hz:.4g} Hz are stated: check which of the two is "
            "right, the unit of the time column (s, not ms), and whether samples were left out when it was exported"
        )


def _usual_interval(time_s: Floats, steps: Floats) -> float:
    backward = np.flatnonzero(steps <= 0.0)
    if backward.size:
        row = int(backward[0]) + 2
        raise RecordingError(
            f"sample {row}: the time {time_s[row - 1]:g} s does not follow {time_s[row - 2]:g} s; times have to "
            "increase: check whether the columns are swapped or two recordings stand in one file",
            row,
        )
    usual_s = float(np.median(steps))
    if NEARLY * LEAST_RATE_HZ <= 1.0 / usual_s <= _MOST_RATE_HZ:
        return usual_s
    raise RecordingError(
        f"the times give {1.0 / usual_s:.4g} samples a second; a recording has {LEAST_RATE_HZ:g} or more "
        f"({NEARLY * LEAST_RATE_HZ:.1f}, since clocks differ), up to {_MOST_RATE_HZ:g}: check "
        "the unit of the time column (s, not ms) and whether the columns are swapped; a recording that was made so "
        "slowly has to be made again"
    )


def _missing(number: Floats, places: Floats) -> Bools:
    """Return which places of the grid lie in a gap between samples, farther than half an interval from either."""
    behind = np.minimum(np.searchsorted(number, places), number.size - 1)
    following, previous = number[behind], number[np.maximum(behind - 1, 0)]
    far = (following - places >= 0.5) & (places - previous >= 0.5)
    return np.asarray(far & (following - previous > _GAP))


def _require_most(time_s: Floats, steps: Floats, size: int) -> None:
    if time_s.size >= (1.0 - _MOST_MISSING) * size:
        return
    row = int(np.argmax(steps)) + 2
    raise RecordingError(
        f"sample {row}: {steps[row - 2]:.4g} s lie between it and the one before; of {size} samples at the usual "
        f"rate, {size - time_s.size} are missing: two recordings may stand in one file; cut it there, or measure "
        "again",
        row,
    )


def _irregular(off: Floats) -> list[Flag]:
    rms = float(np.sqrt(np.mean(off**2)))
    if rms <= _IRREGULAR:
        return []
    text = f"times leave their uniform grid by {100.0 * rms:.0f} % of an interval (rms): the sampling is irregular"
    return [Flag("irregular-sampling", text)]


def _gap_flags(time_s: Floats, steps: Floats, missing: int) -> list[Flag]:
    if not missing:
        return []
    row = int(np.argmax(steps))
    text = (
        f"{missing} samples are missing; the longest gap lasts {steps[row]:.3g} s, from {time_s[row]:.2f} s on "
        f"(behind sample {row + 1}): plateaus go by the samples that are there"
    )
    return [Flag("gap", text)]
