"""A signal that stands still to its last digit while a live one would not: saturated, or without a beam."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording

_SHORTEST_S = 0.2
_FEWEST = 5
_SATURATED_S = 2.0
"""As long as a plateau: what stands at the end of its range for so long is no single glitch."""

_LIVE = 0.5
"""Largest share of samples that equal the one before in a signal whose noise always shows: of a coarser counter, how
often it stands still depends on where within its last digit the joint rests."""

_COUNTS = 2.0
"""Moves of fewer digits in all may leave the signal as it is."""

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
        over_moves: moves were commanded meanwhile, with time to end.
        live: noise always shows elsewhere; otherwise the joint may have stood.
    """

    first: int
    last: int
    start_s: float
    end_s: float
    at_end: bool
    over_moves: bool
    live: bool

    @property
    def text(self) -> str:
        """What was found, what it means and what to do."""
        where = "at the end of its range" if self.at_end else "in mid-range"
        likely = (
            "it is saturated, or the beam was lost; steps there are not real, so"
            if self.live
            else "it is saturated, the beam was lost, or the joint did not follow its commands;"
        )
        return (
            f"from {self.start_s:.2f} s to {self.end_s:.2f} s (samples {self.first + 1} to {self.last + 1}) the "
            f"signal does not change by its last digit, {where}: {likely} keep within the range of the optics and "
            "measure again"
        )


def frozen_stretch(recording: Recording, moves: Moves) -> FrozenStretch | None:
    """Return the longest stretch in which a signal stands still that is otherwise alive; None without one.

    A quantised counter shows equal samples by chance, the more of them the larger its quantum is beside its noise. So
    a stretch counts if it lasts 0.2 s or more and longer than chance makes it anywhere in the recording, by how often
    other samples equal the one before. Where noise does not always show, it has to last through commanded moves: what
    rests may stand still for as long as it rests.

    Args:
        recording: of the signal.
        moves: commanded meanwhile, by the same clock and in the same unit.
    """
    there = slice(None) if recording.missing is None else ~recording.missing
    time_s, position = recording.time_s()[there], recording.position[there]
    changes = np.diff(position)
    edges = np.concatenate([[-1], np.flatnonzero(changes != 0.0), [position.size - 1]])
    firsts, lasts, lengths = edges[:-1] + 1, edges[1:], np.diff(edges)
    over_moves = _over_moves(time_s[firsts], time_s[lasts], moves, changes)
    for lengths_of in (np.where(over_moves, lengths, 0), lengths):
        longest = int(np.argmax(lengths_of))
        first, last = int(firsts[longest]), int(lasts[longest])
        others = lengths[position[firsts] != position[first]]
        if not others.size or lengths_of[longest] < _least_length(others, recording.rate_hz, position.size):
            continue
        live = 1.0 - others.size / float(others.sum()) <= _LIVE
        if live or over_moves[longest]:
            at_end = bool(position[first] in (position.min(), position.max()))
            return FrozenStretch(
                first,
                last,
                float(time_s[first]),
                float(time_s[last]),
                at_end,
                bool(over_moves[longest]),
                live,
            )
    return None


def _over_moves(start_s: Floats, end_s: Floats, moves: Moves, changes: Floats) -> Bools:
    """Return which stretches contain moves that a signal shows, from their command to the rest behind them."""
    if not changes.any():
        return np.zeros(start_s.size, dtype=np.bool_)
    done = np.concatenate([[0.0], np.cumsum(np.abs(moves.command))])
    first = np.searchsorted(moves.time_s, start_s)
    end = np.maximum(np.searchsorted(moves.time_s, end_s - 0.5 * moves.dwell_s), first)
    digit = float(np.abs(changes[changes != 0.0]).min())
    return np.asarray((end > first) & (done[end] - done[first] > _COUNTS * digit))


def frozen_flags(found: FrozenStretch | None) -> list[Flag]:
    """Return a flag for a stretch, none without one."""
    return [] if found is None else [Flag("frozen-signal", found.text)]


def require_unsaturated(found: FrozenStretch | None) -> None:
    """Refuse a live signal that stands at the end of its range for as long as a plateau, whatever is commanded.

    Raises:
        RecordingError: names the sample at which that begins.
    """
    if found is None or not (found.at_end and found.over_moves and found.live):
        return
    if found.end_s - found.start_s >= _SATURATED_S:
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
