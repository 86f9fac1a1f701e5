"""Whether the motor torque changes its sign with the direction: the criterion for play (the paper, section 3.5)."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.errors import MovesError, RecordingError
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.torque_clock import torque_lag

_FEWEST = 2


@dataclass(frozen=True)
class TorqueSigns:
    """Motor torque by direction of approach, N m.

    Attributes:
        forward_nm: mean while interior positions are approached forwards, and until the next move.
        backward_nm: the same backwards.
        u_forward_nm: its standard uncertainty, from the scatter over the sequences in this direction.
        u_backward_nm: the same backwards.
        sequences: how many there are in each direction, at least two.
        late_s: how long behind the reversals the torque changes, but for whole sequences, s: it is by another clock;
            0 where it changes with them, or not at all.
    """

    forward_nm: float
    backward_nm: float
    u_forward_nm: float
    u_backward_nm: float
    sequences: int
    late_s: float = 0.0

    @property
    def change(self) -> bool:
        """Both means differ from zero significantly, and their signs from one another."""
        # Whoever only lists procedures imports this module too.
        from scipy import special

        limit = float(special.stdtrit(self.sequences - 1, 1.0 - 0.5 * SIGNIFICANCE))
        clear = abs(self.forward_nm) > limit * self.u_forward_nm
        clear = clear and abs(self.backward_nm) > limit * self.u_backward_nm
        return clear and self.forward_nm * self.backward_nm < 0.0


def require_increasing(time_s: Floats) -> None:
    """Refuse times of a torque that do not increase.

    Args:
        time_s: s, shape (k,).

    Raises:
        RecordingError: names the times; its row is the place of the first one that does not follow.
    """
    late = np.flatnonzero(~(np.diff(time_s) > 0.0))
    if late.size:
        row = int(late[0]) + 2
        raise RecordingError(
            f"the torque at {time_s[row - 1]:g} s does not follow the one at {time_s[row - 2]:g} s: times have to "
            "increase; check whether the columns are swapped or two traces stand in one file",
            row,
        )


def torque_signs(moves: Moves, counted: Bools, time_s: Floats, torque_nm: Floats) -> TorqueSigns:
    """Return the mean torque in both directions.

    Args:
        moves: in sequences forth and back.
        counted: which moves count: those after a reversal still carry the torque from before it, shape (n,).
        time_s: times of the torque by the clock of the moves, s, shape (k,).
        torque_nm: N m, shape (k,).

    Raises:
        MovesError: the torque does not cover the moves, or there are fewer than two sequences in a direction.
        RecordingError: the times do not increase.
        ArgumentError: torque and times are of different length, or a torque is not finite.
    """
    require_shape(torque_nm, time_s.shape, "torque_nm")
    require_finite(torque_nm, "torque_nm")
    require_increasing(time_s)
    ends = np.append(moves.time_s[1:], moves.time_s[-1] + moves.dwell_s)
    first, end = np.searchsorted(time_s, moves.time_s), np.searchsorted(time_s, ends)
    without = np.flatnonzero(counted & (end <= first))
    if without.size:
        number = int(without[0]) + moves.first
        raise MovesError(
            f"no torque was recorded at move {number}, {moves.time_s[without[0]]:g} s: the torque is cut off, of "
            "another run, or by another clock",
            number,
        )
    sums = np.concatenate([[0.0], np.cumsum(torque_nm)])
    means = (sums[end] - sums[first]) / np.maximum(end - first, 1)
    sequence = np.concatenate([[0], np.cumsum(np.diff(moves.directions) != 0)])
    forward, backward = (
        _by_sequence(means, sequence, counted & (moves.directions == way)) for way in (1, -1)
    )
    count = min(forward.size, backward.size)
    if count < _FEWEST:
        raise MovesError(
            f"{count} sequence(s) in a direction do not show how the torque scatters: the test has five"
        )
    late_s = torque_lag(moves, means) * moves.dwell_s
    return TorqueSigns(
        float(forward.mean()),
        float(backward.mean()),
        _u_of_mean(forward),
        _u_of_mean(backward),
        count,
        late_s,
    )


def _by_sequence(means: Floats, sequence: Floats, chosen: Bools) -> Floats:
    return np.array([means[chosen & (sequence == one)].mean() for one in np.unique(sequence[chosen])])


def _u_of_mean(values: Floats) -> float:
    return float(values.std(ddof=1)) / math.sqrt(values.size)
