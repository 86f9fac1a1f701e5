"""A recording of a position at a uniform rate, and what makes one unfit to be evaluated."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_one_of, require_shape
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.outliers import outliers
from catseye.calibration.resolution.quantum import quantum
from catseye.calibration.resolution.sampling import gridded
from catseye.calibration.resolution.units import Unit, shown


@dataclass(frozen=True)
class Recording:
    """Positions at uniform times.

    Attributes:
        start_s: time of the first sample by the recording's clock, s.
        rate_hz: samples a second.
        position: shape (n,); interpolated where none was recorded.
        unit: of the position.
        flags: what was noticed about the samples.
        missing: where none was recorded, shape (n,); None where nothing is missing.
        quantum: step of the counter, in the unit of the position; 0 where readings show none.
    """

    start_s: float
    rate_hz: float
    position: Floats
    unit: Unit
    flags: tuple[Flag, ...] = ()
    missing: Bools | None = None
    quantum: float = 0.0

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
        """Return the positions that were recorded from a time to another one, without the sample at its end."""
        part = slice(self.index(start_s), self.index(end_s))
        return self.position[part] if self.missing is None else self.position[part][~self.missing[part]]

    def clipped(self, start_s: float, end_s: float) -> "Recording":
        """Return the part between two times."""
        first, end = self.index(start_s), self.index(end_s)
        return replace(
            self,
            start_s=self.start_s + first / self.rate_hz,
            position=self.position[first:end],
            missing=None if self.missing is None else self.missing[first:end],
        )


def recording_of(time_s: Floats, position: Floats, unit: Unit) -> Recording:
    """Return a recording of times and positions.

    Args:
        time_s: times of the samples, s, shape (n,).
        position: rad or mm, shape (n,).

    Raises:
        RecordingError: a number is missing, times do not increase, the rate cannot be that of a recording, or most
            samples are missing; the text names the sample and what to do.
        ArgumentError: the columns are of different length, or the unit is unknown.
    """
    require_one_of(Unit, unit, "unit")
    require_shape(position, time_s.shape, "position")
    _require_numbers(time_s, "time")
    _require_numbers(position, "position")
    if time_s.size < 2:
        raise RecordingError("the recording has fewer than two samples: it is empty or was cut off")
    digit = quantum(position)
    # Whether the times can be those of a recording is seen to below.
    span_s = float(time_s[-1] - time_s[0])
    off = outliers(position, digit, (time_s.size - 1) / span_s if span_s > 0.0 else 0.0)
    grid = gridded(time_s, np.asarray(position, dtype=np.float64), off == 0.0)
    return Recording(
        float(time_s[0]),
        1.0 / grid.interval_s,
        grid.position,
        unit,
        (*grid.flags, *_outlier_flags(time_s, off, unit)),
        grid.missing,
        digit,
    )


def _outlier_flags(time_s: Floats, off: Floats, unit: Unit) -> list[Flag]:
    if not off.any():
        return []
    first = int(np.flatnonzero(off)[0])
    text = (
        f"{np.count_nonzero(off)} of {off.size} samples lie far off those around them, and were left out (the first "
        f"is sample {first + 1} at {time_s[first]:.2f} s, by {shown(float(off[first]), unit)}): the signal was "
        "disturbed; look at beam and link"
    )
    return [Flag("outlier", text)]


def _require_numbers(values: Floats, what: str) -> None:
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        row = int(wrong[0]) + 1
        raise RecordingError(
            f"sample {row} has no {what} ({wrong.size} of {values.size} are missing or infinite): the beam was lost "
            "or the file is damaged; measure again, or export the recording again",
            row,
        )
