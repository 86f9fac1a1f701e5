"""Where the joint rests between two moves: the last part of each dwell, when it has settled."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording

GUARD_S = 0.25
"""Half the window of the smoothing: a plateau ends this long before the next move."""

_LONGEST_S = 2.0
_SHARE = 0.4
"""Longest share of the time between two moves that counts as plateau; the rest is motion and settling."""

_LAST_SHARE = 0.8
"""A recording may end at this share of the shortest time between two moves after the last one."""

_FEWEST = 4
_MOST_LOST = 0.5
"""Share of plateaus without samples from which on this is no recording of the moves."""


@dataclass(frozen=True)
class Plateaus:
    """Rests before the first move, between moves, and after the last one: one more than there are moves.

    Attributes:
        start_s: begin of each, s, shape (n + 1,).
        length_s: how long each lasts, s.
        mean: mean position on each, NaN where too few samples are there, shape (n + 1,).
        half_difference: mean of its second half minus that of its first, NaN likewise, shape (n + 1,).
        loss: variance of the mean as a multiple of that of a plateau without gaps, by how many samples are there,
            NaN likewise, shape (n + 1,).
    """

    start_s: Floats
    length_s: float
    mean: Floats
    half_difference: Floats
    loss: Floats

    @property
    def middle_s(self) -> Floats:
        """Time at which each mean holds, s, shape (n + 1,)."""
        return self.start_s + 0.5 * self.length_s


def plateaus(recording: Recording, moves: Moves) -> Plateaus:
    """Return the plateaus around the moves.

    Raises:
        MovesError: the recording does not cover them all, gaps swallow most of them, or the moves follow one another
            too fast.
    """
    length_s = min(_LONGEST_S, _SHARE * float(np.diff(moves.time_s).min()))
    if length_s * recording.rate_hz < _FEWEST:
        row = int(np.diff(moves.time_s).argmin()) + 1 + moves.first
        raise MovesError(
            f"move {row} follows the one before after {np.diff(moves.time_s).min():.3g} s: a plateau needs "
            f"{_FEWEST} samples or more within {100 * _SHARE:.0f} % of it; dwell longer, or record faster",
            row,
        )
    last_s = min(
        moves.dwell_s - GUARD_S,
        max(recording.end_s - moves.time_s[-1], _LAST_SHARE * float(np.diff(moves.time_s).min())),
    )
    ends = np.append(moves.time_s - GUARD_S, moves.time_s[-1] + last_s)
    start = ends - length_s
    _require_covered(recording, moves, float(start[0]), ends)
    halves = [
        (recording.between(a, a + 0.5 * length_s), recording.between(a + 0.5 * length_s, b))
        for a, b in zip(start, ends, strict=True)
    ]
    counts = np.array([[half.size for half in both] for both in halves])
    there = np.all(counts >= _FEWEST // 2, axis=1)
    _require_most(there)
    means = np.full(counts.shape, np.nan)
    means[there] = [
        [half.mean() for half in both] for both, found in zip(halves, there, strict=True) if found
    ]
    loss = np.full(there.size, np.nan)
    loss[there] = 1.0
    if recording.missing is not None:
        # Against the places of each: their number differs by one, as the ends fall between two samples.
        edges = [
            [recording.index(time_s) for time_s in (a, a + 0.5 * length_s, b)]
            for a, b in zip(start, ends, strict=True)
        ]
        places = np.diff(edges, axis=1)
        loss[there] = (1.0 / counts[there]).sum(axis=1) / (1.0 / places[there]).sum(axis=1)
    first, second = means.T
    return Plateaus(start, length_s, 0.5 * (first + second), second - first, loss)


def _require_most(there: Bools) -> None:
    if np.count_nonzero(there) <= _MOST_LOST * there.size:
        raise MovesError(
            f"{np.count_nonzero(~there)} of {there.size} plateaus have no samples: gaps of the recording swallow "
            "them; measure again at a steady rate"
        )


def _require_covered(recording: Recording, moves: Moves, start_s: float, ends_s: Floats) -> None:
    tolerance_s = 1.0 / recording.rate_hz
    if start_s < recording.start_s - tolerance_s:
        raise MovesError(
            f"the recording begins at {recording.start_s:g} s, but the plateau before the first move, commanded at "
            f"{moves.time_s[0]:g} s, at {start_s:g} s: these are moves of another run, the clocks "
            "differ (align them), or the recording was started too late",
            moves.first,
        )
    beyond = np.flatnonzero(ends_s[1:] > recording.end_s + tolerance_s)
    if beyond.size:
        place = int(beyond[0])
        number = place + moves.first
        raise MovesError(
            f"the recording ends at {recording.end_s:g} s, but move {number} of {len(moves) + moves.first - 1}, "
            f"commanded at {moves.time_s[place]:g} s, rests until {ends_s[place + 1]:g} s: the recording is cut off, "
            "its times are not of the rate at which it was made, these are moves of another run, or the clocks "
            f"differ (align them); to judge what was recorded, leave out the moves from {number} on",
            number,
        )
