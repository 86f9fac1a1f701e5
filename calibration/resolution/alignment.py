"""Two clocks: by how much that of the recording is ahead of that of the moves, and what it gains.

First every offset is tried at which the recording covers all moves: what the position does over each dwell is
compared with the commands. Then the velocity peaks of the larger steps give the drift, and what is common to all
motions shows when they begin. A delay of that behind the command is part of the offset: no recording can tell it
from a clock that is ahead.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.begin import EARLY_S, motion_begin_s
from catseye.calibration.resolution.errors import ClockError
from catseye.calibration.resolution.lowess import WINDOW_S, half_window, lowess
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.speed import speed_of

_GRID_S = 0.05
_NEAR = 0.05
"""What a joint does within so much of a dwell about either end is motion, where it should rest."""

_EXPLAINED = 0.5
"""Share of the commands' sum of squares that no offset may leave unexplained."""

_CLEAR = 10.8
"""F of one degree of freedom that chance exceeds once in a thousand: how much worse any other cell has to be."""

_U_BEGIN_S = (0.5 * WINDOW_S - EARLY_S) / math.sqrt(3.0)
"""Standard uncertainty of the begin: any time between the two (GUM 4.3.7)."""

_SEEN = 8.0
_FEWEST_PEAKS = 6
_SIMILAR = 0.1
_NORMAL_MAD = 1.4826


@dataclass(frozen=True)
class ClockAlignment:
    """The recording's clock against that of the moves.

    Attributes:
        offset_s: what it is ahead at `about_s`, the delay between a command and the begin of its motion included, s.
        u_offset_s: standard uncertainty of the sum of both, s.
        drift: what it gains a second.
        u_drift: standard uncertainty.
        about_s: time by the clock of the moves at which the offset holds, s.
        peaks: steps that it comes from.
    """

    offset_s: float
    u_offset_s: float
    drift: float
    u_drift: float
    about_s: float
    peaks: int

    def moves(self, moves: Moves) -> Moves:
        """Return the moves by the recording's clock, at the begin of their motion."""
        return moves.delayed(self.offset_s, self.drift, self.about_s)

    def times_s(self, time_s: Floats) -> Floats:
        """Return times of the moves' clock by that of the recording: of a torque traced with the moves."""
        return np.asarray(time_s + self.offset_s + self.drift * (time_s - self.about_s))


def align(recording: Recording, moves: Moves) -> ClockAlignment:
    """Find offset and drift of the two clocks.

    Raises:
        ClockError: the recording is shorter than the moves take, no offset explains the moves, another offset does so
            as well, or too few steps stand out.
    """
    offset_s = _coarse_offset(recording, moves)
    about_s = float(moves.time_s.mean())
    lag_s, size = _peak_lags(recording, moves.delayed(offset_s, 0.0, about_s))
    good = np.isfinite(lag_s)
    if np.count_nonzero(good) < _FEWEST_PEAKS:
        raise ClockError(
            f"{np.count_nonzero(good)} steps stand out of the noise: the alignment of the clocks needs "
            f"{_FEWEST_PEAKS} or more; use a test with larger steps"
        )
    since_s = moves.time_s - about_s
    columns = [np.ones(size.size), since_s]
    if np.ptp(size[good]) > _SIMILAR * size[good].max():
        columns.append(size / size.max())
    found, covariance = _fitted(np.column_stack(columns)[good], lag_s[good])
    fastest = moves.delayed(offset_s + float(found[0]), float(found[1]), about_s)
    begin_s = motion_begin_s(recording, fastest)
    if not math.isfinite(begin_s):
        raise ClockError(
            f"the motions take most of the {moves.dwell_s:.3g} s from one move to the next: when they begin does not "
            "show, so the clocks cannot be aligned; dwell longer, or move faster"
        )
    return ClockAlignment(
        offset_s=offset_s + float(found[0]) + begin_s,
        u_offset_s=math.hypot(math.sqrt(covariance[0, 0]), _U_BEGIN_S),
        drift=float(found[1]),
        u_drift=math.sqrt(covariance[1, 1]),
        about_s=about_s,
        peaks=int(np.count_nonzero(good)),
    )


def _coarse_offset(recording: Recording, moves: Moves) -> float:
    """Return the offset, on a grid, at which the recording shows the commanded steps."""
    half_s = 0.5 * moves.dwell_s
    first_s = recording.start_s - moves.time_s[0] + half_s
    last_s = recording.end_s - moves.time_s[-1] - half_s
    if last_s < first_s:
        raise ClockError(
            f"the recording lasts {recording.end_s - recording.start_s:.4g} s, the moves take "
            f"{moves.time_s[-1] - moves.time_s[0] + moves.dwell_s:.4g} s: it does not cover them, whatever the "
            "clocks show; it is cut off, or of another run"
        )
    offsets = np.arange(first_s, last_s + _GRID_S, _GRID_S)
    misfit = _misfits(recording, moves, offsets, half_s)
    best = int(np.argmin(misfit))
    _require_explained(float(misfit[best]), moves)
    fitting = offsets[misfit <= misfit[best] * (1.0 + _CLEAR / max(len(moves) - 1, 1))]
    _require_clear(fitting, moves.dwell_s)
    # A step fits wherever its motion lies within the dwell: the middle of those offsets stands for them.
    return 0.5 * float(fitting[0] + fitting[-1])


def _misfits(recording: Recording, moves: Moves, offsets: Floats, half_s: float) -> Floats:
    """Return for each offset the sum of squares of what the position does about each move minus the command.

    What it does at either end of a dwell adds to it: between two steps of one size, half of each would fit as well.
    """
    time_s, position = recording.time_s(), lowess(recording.position, half_window(recording.rate_hz))
    total, near_s = np.zeros(offsets.size), _NEAR * moves.dwell_s
    for at_s, command in zip(moves.time_s.tolist(), moves.command.tolist(), strict=True):
        (behind, left), (right, ahead) = (
            [np.interp(at_s + offsets + side_s + more_s, time_s, position) for more_s in (-near_s, near_s)]
            for side_s in (-half_s, half_s)
        )
        total += (0.5 * (right + ahead - behind - left) - command) ** 2
        total += (left - behind) ** 2 + (ahead - right) ** 2
    return total


def _require_explained(misfit: float, moves: Moves) -> None:
    whole = float(moves.command @ moves.command)
    if misfit > _EXPLAINED * whole:
        raise ClockError(
            f"at no offset of the clocks does the recording show the moves (the best one leaves "
            f"{100.0 * misfit / whole:.0f} % of them): these are moves of another run or joint, or sign, "
            "spacing or unit are wrong"
        )


def _require_clear(fitting: Floats, dwell_s: float) -> None:
    """Refuse offsets that differ by a dwell: those at which the same steps fit all lie nearer together."""
    others = fitting[fitting - fitting[0] >= dwell_s - 2.0 * _GRID_S]
    if not others.size:
        return
    one_s = float(fitting[: -others.size].mean())
    other_s = float(others[others - others[0] < dwell_s].mean())
    number = max(1, round((other_s - one_s) / dwell_s))
    raise ClockError(
        f"the moves fit the recording at an offset of {one_s:.1f} s and as well at {other_s:.1f} s, {number} "
        f"dwell{'s' if number > 1 else ''} away: the offset is ambiguous; record from the standstill before the "
        "first move until after the last one, or correct the times of the moves"
    )


def _peak_lags(recording: Recording, moves: Moves) -> tuple[Floats, Floats]:
    """Return how far behind its time each move was fastest, s, NaN where that does not stand out, and its size."""
    speed = speed_of(recording)
    limit = _SEEN * _NORMAL_MAD * float(np.nanmedian(np.abs(speed)))
    half_s, lags = 0.5 * moves.dwell_s, np.full(len(moves), np.nan)
    for number, (at_s, way) in enumerate(zip(moves.time_s.tolist(), moves.directions.tolist(), strict=True)):
        first, end = recording.index(at_s - half_s), recording.index(at_s + half_s) - 1
        window = np.nan_to_num(way * speed[first:end], nan=-np.inf)
        fastest = int(np.argmax(window))
        if window[fastest] > limit:
            lags[number] = recording.start_s + (first + fastest + 0.5) / recording.rate_hz - at_s
    return lags, np.abs(moves.command)


def _fitted(design: Floats, lag_s: Floats) -> tuple[Floats, Floats]:
    """Return the parameters of lags and their covariance, without lags far off the others."""
    good = np.ones(lag_s.size, dtype=np.bool_)
    for _ in range(3):
        found = np.linalg.lstsq(design[good], lag_s[good], rcond=None)[0]
        off = np.abs(lag_s - design @ found)
        good = off <= max(4.0 * _NORMAL_MAD * float(np.median(off)), 1e-9)
    left = lag_s[good] - design[good] @ found
    variance = float(left @ left) / max(int(good.sum()) - design.shape[1], 1)
    covariance = variance * np.linalg.inv(design[good].T @ design[good])
    return np.asarray(found, dtype=np.float64), np.asarray(covariance, dtype=np.float64)
