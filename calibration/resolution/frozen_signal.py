"""A signal that stands still to its last digit while a live one would not: saturated, or without a beam."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.flags import Flag

_SHORTEST_S = 0.2
_FEWEST = 5
_SATURATED_S = 2.0
"""As long as a plateau: what stands at the end of its range for so long is no single glitch."""

_USUALLY_ALIVE = 0.9
"""Share of the other samples that change: a coarse or noiseless signal stands still most of the time."""

_CHANCE = 1e-3
"""Probability that a quantised signal stands still as long anywhere in the recording."""

_CORRELATED = 2.0
"""Noise of neighbouring samples is correlated: equal ones follow one another longer than independent ones."""


@dataclass(frozen=True)
class FrozenStretch:
    """The longest stretch of equal samples.

    Attributes:
        first: its first sample, from 0.
        last: its last sample.
        start_s: time of the first one, s.
        end_s: time of the last one, s.
        at_end: it stands at the largest or smallest value of the recording.
    """

    first: int
    last: int
    start_s: float
    end_s: float
    at_end: bool

    @property
    def text(self) -> str:
        """What was found, what it means and what to do."""
        where = "at the end of its range" if self.at_end else "in mid-range"
        return (
            f"from {self.start_s:.2f} s to {self.end_s:.2f} s (samples {self.first + 1} to {self.last + 1}) the "
            f"signal does not change by its last digit, {where}: it is saturated, or the beam was lost; steps there "
            "are not real, so keep within the range of the optics and measure again"
        )


def frozen_stretch(time_s: Floats, rate_hz: float, position: Floats) -> FrozenStretch | None:
    """Return the longest stretch in which a signal stands still that is otherwise alive; None without one.

    A quantised counter shows equal samples by chance, the more of them the larger its quantum is beside its noise. So
    a stretch counts if it lasts 0.2 s or more and longer than chance makes it anywhere in the recording, by how often
    other samples equal the one before.

    Args:
        time_s: of the samples, s, shape (n,).
        rate_hz: samples a second.
        position: shape (n,).
    """
    edges = np.concatenate([[-1], np.flatnonzero(np.diff(position) != 0.0), [position.size - 1]])
    lengths = np.diff(edges)
    longest = int(np.argmax(lengths))
    first, last = int(edges[longest]) + 1, int(edges[longest + 1])
    others = lengths[position[edges[:-1] + 1] != position[first]]
    if not others.size or lengths[longest] < _least_length(others, rate_hz, position.size):
        return None
    at_end = bool(position[first] in (position.min(), position.max()))
    return FrozenStretch(first, last, float(time_s[first]), float(time_s[last]), at_end)


def frozen_flags(found: FrozenStretch | None) -> list[Flag]:
    """Return a flag for a stretch, none without one."""
    return [] if found is None else [Flag("frozen-signal", found.text)]


def require_unsaturated(found: FrozenStretch | None) -> None:
    """Refuse a signal that stands at the end of its range for as long as a plateau.

    Raises:
        RecordingError: names the sample at which that begins.
    """
    if found is not None and found.at_end and found.end_s - found.start_s >= _SATURATED_S:
        raise RecordingError(found.text, found.first + 1)


def _least_length(others: Ints, rate_hz: float, size: int) -> float:
    """Return from how many equal samples on a stretch says something; infinite where none does.

    Args:
        others: lengths of the other stretches of equal samples, shape (m,).
        size: of the recording.
    """
    total = int(others.sum())
    equal = max(1.0 - others.size / total, np.finfo(float).tiny)
    by_chance = _CORRELATED * math.log(_CHANCE / size) / math.log(equal)
    least = max(float(_FEWEST), _SHORTEST_S * rate_hz, by_chance)
    if int(others[others >= least].sum()) > (1.0 - _USUALLY_ALIVE) * total:
        return math.inf
    return least
