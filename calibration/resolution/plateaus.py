"""Where the joint rests between two moves: the last part of each dwell, when it has settled."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording

GUARD_S = 0.25
"""Half the window of the smoothing: a plateau ends this long before the next move."""

_LONGEST_S = 2.0
_SHARE = 0.4
"""Longest share of the time between two moves that counts as plateau; the rest is motion and settling."""

_LAST_SHARE = 0.8
"""A recording may end at this share of the last dwell."""

_FEWEST = 4


@dataclass(frozen=True)
class Plateaus:
    """Rests before the first move, between moves, and after the last one: one more than there are moves.

    Attributes:
        start_s: begin of each, s, shape (n + 1,).
        length_s: how long each lasts, s.
        mean: mean position on each, shape (n + 1,).
        half_difference: mean of its second half minus that of its first, shape (n + 1,).
    """

    start_s: Floats
    length_s: float
    mean: Floats
    half_difference: Floats

    @property
    def middle_s(self) -> Floats:
        """Time at which each mean holds, s, shape (n + 1,)."""
        return self.start_s + 0.5 * self.length_s


def plateaus(recording: Recording, moves: Moves) -> Plateaus:
    """Return the plateaus around the moves.

    Raises:
        MovesError: the recording does not cover them all, or the moves follow one another too fast.
    """
    length_s = min(_LONGEST_S, _SHARE * float(np.diff(moves.time_s).min()))
    if length_s * recording.rate_hz < _FEWEST:
        row = int(np.diff(moves.time_s).argmin()) + 2
        raise MovesError(
            f"move {row} follows the one before after {np.diff(moves.time_s).min():.3g} s: a plateau needs "
            f"{_FEWEST} samples or more within {100 * _SHARE:.0f} % of it; dwell longer, or record faster"
        )
    last_s = min(
        moves.dwell_s - GUARD_S, max(recording.end_s - moves.time_s[-1], _LAST_SHARE * moves.dwell_s)
    )
    ends = np.append(moves.time_s - GUARD_S, moves.time_s[-1] + last_s)
    start = ends - length_s
    _require_covered(recording, moves, float(start[0]), ends)
    halves = [
        (recording.between(a, a + 0.5 * length_s).mean(), recording.between(a + 0.5 * length_s, b).mean())
        for a, b in zip(start, ends, strict=True)
    ]
    first, second = np.array(halves).T
    return Plateaus(start, length_s, 0.5 * (first + second), second - first)


def _require_covered(recording: Recording, moves: Moves, start_s: float, ends_s: Floats) -> None:
    tolerance_s = 1.0 / recording.rate_hz
    if start_s < recording.start_s - tolerance_s:
        raise MovesError(
            f"the recording begins at {recording.start_s:g} s, but the plateau before the first move, commanded at "
            f"{moves.time_s[0]:g} s, at {start_s:g} s: these are moves of another run, the clocks "
            "differ (align them), or the recording was started too late"
        )
    beyond = np.flatnonzero(ends_s[1:] > recording.end_s + tolerance_s)
    if beyond.size:
        row = int(beyond[0]) + 1
        raise MovesError(
            f"the recording ends at {recording.end_s:g} s, but move {row} of {len(moves)}, commanded at "
            f"{moves.time_s[row - 1]:g} s, rests until {ends_s[row]:g} s: the recording is cut off, these are "
            f"moves of another run, or the clocks differ (align them); to judge what was recorded, "
            f"leave out the moves from {row} on"
        )
