"""Whether a motor torque is by the clock of the moves: it changes where the direction does."""

from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.moves import Moves

_NO_CLOCK: Final = 2
"""Moves that friction may take to turn round, and that hardly change the mean of a sequence."""

_BETTER: Final = 0.5
"""Share of the squares that another clock leaves at most: noise alone never gains so much."""


def torque_lag(moves: Moves, mean_nm: Floats) -> int:
    """Return how many moves behind the reversals the torque changes; 0 for none, and where it does not show.

    A whole sequence more or less looks the same but for the sign, which drives count either way.

    Args:
        moves: in sequences forth and back.
        mean_nm: mean torque from each move to the next one, N m, shape (n,).
    """
    direction = moves.directions.astype(np.float64)
    turns = np.flatnonzero(np.diff(direction))
    if not turns.size:
        return 0
    half = int(np.median(np.diff(np.append(-1, turns)))) // 2
    lags = [lag for size in range(_NO_CLOCK + 1, half + 1) for lag in (size, -size)]
    gains = {lag: _gain(direction, np.cumsum(moves.command), mean_nm, lag) for lag in lags}
    best = min(gains, key=lambda lag: gains[lag], default=0)
    return best if best and gains[best] < _BETTER else 0


def _gain(direction: Floats, position: Floats, mean_nm: Floats, lag: int) -> float:
    """Return the sum of squares that a torque leaves that changes so late, as a share of that of one in time."""
    inside = np.arange(max(lag, 0), direction.size + min(lag, 0))
    # The weight of an arm is a torque that changes with the position.
    common = np.column_stack([np.ones(inside.size), position[inside] / np.ptp(position)])
    late, timely = (_left(common, direction[inside - by], mean_nm[inside]) for by in (lag, 0))
    # What rounding leaves of a torque that does not change says nothing of a clock.
    rounding = np.finfo(float).eps * float(mean_nm[inside] @ mean_nm[inside])
    return late / timely if timely > rounding else 1.0


def _left(common: Floats, direction: Floats, mean_nm: Floats) -> float:
    design = np.column_stack([common, direction])
    rest = mean_nm - design @ np.linalg.lstsq(design, mean_nm, rcond=None)[0]
    return float(rest @ rest)
