"""A recording of a position at a uniform rate, and what makes one unfit to be evaluated."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_one_of, require_shape
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.units import Unit

LEAST_RATE_HZ = 20.0
"""Below it, a window of 0.5 s has too few samples for a local line."""

_MOST_RATE_HZ = 1e6
_GAP = 1.5
"""An interval this many times the usual one lacks a sample."""

_IRREGULAR = 0.05
"""Deviation from the uniform grid, rms, in intervals, from which sampling is flagged."""

_FROZEN_S = 0.2
_FEWEST_FROZEN = 5
_USUALLY_ALIVE = 0.9
_BY_CHANCE = 1e-3
"""Probability that a recording of a sound signal of few digits holds a stretch that counts as frozen."""


@dataclass(frozen=True)
class Recording:
    """Positions at uniform times.

    Attributes:
        start_s: time of the first sample by the recording's clock, s.
        rate_hz: samples a second.
        position: shape (n,).
        unit: of the position.
        flags: what was noticed about the samples.
    """

    start_s: float
    rate_hz: float
    position: Floats
    unit: Unit
    flags: tuple[Flag, ...] = ()

    @property
    def end_s(self) -> float:
        """Time of the last sample, s."""
        return self.start_s + (self.position.size - 1) / self.rate_hz

    def time_s(self) -> Floats:
        """Return the times of the samples, s, shape (n,)."""
        return self.start_s + np.arange(self.position.size) / self.rate_hz

    def index(self, time_s: float) -> int:
        """Return the first sample at or after a time; that of an end of the recording for times beyond it."""
        # Times that are multiples of the interval land on their sample, whatever their last digit.
        wanted = int(np.ceil((time_s - self.start_s) * self.rate_hz - 1e-6))
        return min(max(wanted, 0), self.position.size)

    def between(self, start_s: float, end_s: float) -> Floats:
        """Return the positions from a time to another one, without the sample at its end."""
        return self.position[self.index(start_s) : self.index(end_s)]

    def clipped(self, start_s: float, end_s: float) -> "Recording":
        """Return the part between two times."""
        first, end = self.index(start_s), self.index(end_s)
        return Recording(
            self.start_s + first / self.rate_hz, self.rate_hz, self.position[first:end], self.unit, self.flags
        )


def recording_of(time_s: Floats, position: Floats, unit: Unit) -> Recording:
    """Return a recording of times and positions.

    Args:
        time_s: times of the samples, s, shape (n,).
        position: rad or mm, shape (n,).

    Raises:
        RecordingError: a number is missing, times do not increase or leave the uniform grid, or the rate cannot be
            that of a recording; the text names the sample and what to do.
        ArgumentError: the columns are of different length, or the unit is unknown.
    """
    require_one_of(Unit, unit, "unit")
    require_shape(position, time_s.shape, "position")
    _require_numbers(time_s, "time")
    _require_numbers(position, "position")
    if time_s.size < 2:
        raise RecordingError("the recording has fewer than two samples: it is empty or was cut off")
    interval_s = _interval(time_s)
    flags = [*_irregular(time_s, interval_s), *frozen_signal(time_s[0], 1.0 / interval_s, position)]
    return Recording(
        float(time_s[0]), 1.0 / interval_s, np.asarray(position, dtype=np.float64), unit, tuple(flags)
    )


def frozen_signal(start_s: float, rate_hz: float, position: Floats) -> list[Flag]:
    """Return a flag for the longest stretch in which a noisy signal stands still to its last digit.

    A saturated signal does so at its largest or smallest value, one whose beam is lost anywhere.

    Args:
        start_s: time of the first sample, s.
        position: shape (n,).
    """
    changes = np.flatnonzero(np.diff(position) != 0.0)
    least = max(_FEWEST_FROZEN, round(_FROZEN_S * rate_hz), _beyond_chance(position.size, changes.size))
    edges = np.concatenate([[-1], changes, [position.size - 1]])
    lengths = np.diff(edges)
    frozen = int(lengths[lengths >= least].sum())
    # A coarse or noiseless signal stands still most of the time: that says nothing.
    if not 0 < frozen < (1.0 - _USUALLY_ALIVE) * position.size:
        return []
    longest = int(np.argmax(lengths))
    first, last = int(edges[longest]) + 1, int(edges[longest + 1])
    value = position[first]
    where = "at the end of its range" if value in (position.min(), position.max()) else "in mid-range"
    text = (
        f"from {start_s + first / rate_hz:.2f} s to {start_s + last / rate_hz:.2f} s (samples {first + 1} to "
        f"{last + 1}) the signal does not change by its last digit, {where}: it is saturated, or the beam was lost; "
        "steps there are not real, so keep within the range of the optics and measure again"
    )
    return [Flag("frozen-signal", text)]


def _beyond_chance(samples: int, changes: int) -> int:
    """Return the least number of equal samples in a row that digits as coarse as these do not make by chance."""
    same = 1.0 - changes / max(samples - 1, 1)
    return 1 + math.ceil(math.log(_BY_CHANCE / samples) / math.log(same)) if 0.0 < same < 1.0 else 1


def _require_numbers(values: Floats, what: str) -> None:
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        row = int(wrong[0]) + 1
        raise RecordingError(
            f"sample {row} has no {what} ({wrong.size} of {values.size} are missing or infinite): the beam was lost "
            "or the file is damaged; measure again, or export the recording anew",
            row,
        )


def _interval(time_s: Floats) -> float:
    """Return the interval of the grid that the times lie on, s."""
    steps = np.diff(time_s)
    backward = np.flatnonzero(steps <= 0.0)
    if backward.size:
        row = int(backward[0]) + 2
        raise RecordingError(
            f"sample {row}: the time {time_s[row - 1]:g} s does not follow {time_s[row - 2]:g} s; times have to "
            "increase: check whether the columns are swapped or two recordings stand in one file",
            row,
        )
    usual = float(np.median(steps))
    _require_rate(1.0 / usual)
    gaps = np.flatnonzero(steps > _GAP * usual)
    if gaps.size:
        row = int(gaps[0]) + 2
        raise RecordingError(
            f"sample {row}: {steps[row - 2]:.4g} s lie between it and the one before, {usual:.4g} s elsewhere "
            f"({gaps.size} gaps): samples were lost; measure again, or cut the file before the first gap",
            row,
        )
    return float(time_s[-1] - time_s[0]) / (time_s.size - 1)


def _require_rate(rate_hz: float) -> None:
    if LEAST_RATE_HZ * (1.0 - 1e-6) <= rate_hz <= _MOST_RATE_HZ:
        return
    raise RecordingError(
        f"the times give {rate_hz:.4g} samples a second; a recording has {LEAST_RATE_HZ:g} or more, up to "
        f"{_MOST_RATE_HZ:g}: check the unit of the time column (s, not ms) and whether the columns are swapped"
    )


def _irregular(time_s: Floats, interval_s: float) -> list[Flag]:
    off = (time_s - time_s[0]) / interval_s - np.arange(time_s.size)
    off -= np.median(off)
    rms, row = float(np.sqrt(np.mean(off**2))), int(np.argmax(np.abs(off)))
    if abs(off[row]) >= 1.0:
        raise RecordingError(
            f"sample {row + 1} is {abs(off[row]) * interval_s:.3g} s off the uniform grid of {interval_s:.4g} s: the "
            "rate is not uniform; record at a fixed rate, or resample the file and say so",
            row + 1,
        )
    if rms <= _IRREGULAR:
        return []
    text = f"times leave their uniform grid by {100.0 * rms:.0f} % of an interval (rms): the sampling is irregular"
    return [Flag("irregular-sampling", text)]
