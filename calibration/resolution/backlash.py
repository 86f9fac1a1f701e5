"""Reversal error of a joint from steps forth and back over the same positions, and whether it is lost motion.

The resolution paper, equation 2 and sections 3.5 and 3.6: B is the mean over the positions that are reached from both
sides, forward minus backward, negative where the joint loses motion; lost motion is stated positive here, as in
its Table 5. Ten steps have nine such positions, all of which count. A reversal error is play only where the motor
torque changes its sign between the directions.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.resolution.correlation import correlation_within, mean_variance_factor
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, listed
from catseye.calibration.resolution.scale import is_scaled, scale_text
from catseye.calibration.resolution.steps import Steps
from catseye.calibration.resolution.torque import TorqueSigns, torque_signs

_FEWEST_VISITS = 2
_NO_MOTION = 0.2


@dataclass(frozen=True)
class Backlash:
    """Result of the test, in the unit of the moves.

    Attributes:
        steps: what was measured.
        place: commanded position of each interior position, from where the test began, shape (m,).
        reversal: −B_i at each, positive where motion is lost, shape (m,).
        lost_motion: −B, their mean.
        u: its standard uncertainty: scatter, drift and scale.
        torque: None where none was recorded.
        flags: of the steps and of the result.
    """

    steps: Steps
    place: Floats
    reversal: Floats
    lost_motion: float
    u: float
    torque: TorqueSigns | None
    flags: tuple[Flag, ...]

    @property
    def valid(self) -> bool | None:
        """The torque changes its sign, the reversal error is lost motion; None without one by this clock."""
        return None if self.torque is None or self.torque.late_s else self.torque.change


@dataclass(frozen=True)
class _Groups:
    """Plateaus behind the moves, grouped by position and direction of approach.

    Attributes:
        there: plateaus that no gap of the recording swallows, shape (moves,).
        of: number of the group of each of those, shape (n,).
        forward: group that reaches each interior position forwards, shape (m,).
        backward: the same backwards, shape (m,).
        place: number of each interior position, 0 where the test began, shape (m,).
    """

    there: Bools
    of: Ints
    forward: Ints
    backward: Ints
    place: Ints

    def counts(self) -> Floats:
        """Return how many plateaus each has."""
        return np.bincount(self.of).astype(np.float64)

    def means(self, values: Floats) -> Floats:
        """Return the mean of each group."""
        return np.asarray(np.bincount(self.of, weights=values) / self.counts())

    def interior(self) -> Bools:
        """Return which moves lead to positions that are reached from both sides, shape (moves,)."""
        inside = np.zeros(self.there.size, dtype=np.bool_)
        inside[self.there] = np.isin(self.of, np.concatenate([self.forward, self.backward]))
        return inside


def backlash(steps: Steps, torque_time_s: Floats | None = None, torque_nm: Floats | None = None) -> Backlash:
    """Evaluate steps forth and back over the same positions.

    Args:
        steps: of all cycles, by absolute commands.
        torque_time_s: times of the motor torque, s, by the clock of the moves, shape (k,); None without torque.
        torque_nm: the joint's motor torque, N m, shape (k,); None without torque.

    Raises:
        MovesError: the moves do not come back to the same positions twice from both sides, the recording shows fewer
            of them, all steps are longer or shorter than commanded, or the torque does not cover them.
        ArgumentError: torque and its times are of different length.
    """
    amplitude = steps.moves.equal_size()
    groups = _groups(steps)
    _require_motion(steps)
    _require_scale(steps)
    lost, u_lost, drift = _reversal(steps, groups)
    value = float(lost.mean())
    torque = None
    if torque_time_s is not None and torque_nm is not None:
        torque = torque_signs(steps.moves, groups.interior(), torque_time_s, torque_nm)
    return Backlash(
        steps=steps,
        place=np.asarray(amplitude * groups.place),
        reversal=lost,
        lost_motion=value,
        u=math.hypot(u_lost, steps.u_scale * value),
        torque=torque,
        flags=(*steps.flags, *_drift_flags(drift), *_torque_flags(torque)),
    )


def _groups(steps: Steps) -> _Groups:
    direction, there = steps.moves.directions, np.isfinite(steps.position[1:])
    place = np.cumsum(direction)[there]
    direction = direction[there]
    keys, of = np.unique(np.column_stack([place, direction]), axis=0, return_inverse=True)
    counts = np.bincount(of)
    often = {
        tuple(key): number for number, key in enumerate(keys.tolist()) if counts[number] >= _FEWEST_VISITS
    }
    both = [one for one, way in often if way == 1 and (one, -1) in often]
    if not both:
        raise MovesError(
            f"no position is reached {_FEWEST_VISITS} times or more from either side by the {place.size} moves: the "
            "test goes ten steps forth and ten back, five times; are these moves of another test, or too few?"
        )
    numbers = [np.array([often[one, way] for one in both], dtype=np.int64) for way in (1, -1)]
    return _Groups(there, of.ravel().astype(np.int64), numbers[0], numbers[1], np.array(both, dtype=np.int64))


def _require_motion(steps: Steps) -> None:
    """Refuse a recording in which full steps are missing: any joint follows those that are far above its play."""
    still = np.abs(steps.measured) < _NO_MOTION * np.abs(steps.moves.command)
    if still.any():
        numbers = (np.flatnonzero(still) + 1).tolist()
        raise MovesError(
            f"{listed(numbers)} of {still.size} moved by less than {100 * _NO_MOTION:.0f} % of the command: fewer "
            "steps were driven than commanded, these are moves of another run, or the steps are no larger than the "
            "play; then measure with larger ones",
            numbers[0],
        )


def _require_scale(steps: Steps) -> None:
    """Refuse steps that are all longer or shorter than commanded: the reversal error would be so, too."""
    # What play and torsion take is missing from the step behind a reversal.
    following = np.append(False, np.diff(steps.moves.directions) == 0) & np.isfinite(steps.measured)
    ratio = float(np.median((steps.measured / steps.moves.command)[following]))
    if is_scaled(ratio):
        raise MovesError(
            f"the steps that follow no reversal are {ratio:.3g} times those commanded, in the median: "
            f"{scale_text(ratio)}",
            steps.moves.first,
        )


def _reversal(steps: Steps, groups: _Groups) -> tuple[Floats, float, float]:
    """Return −B_i, the standard uncertainty of their mean, and the probability of the drift that is taken off.

    Positions are reached forwards some dwells before they are reached backwards, so a drift would pass for lost
    motion. It is fitted together with the means of all groups.
    """
    # Whoever only lists procedures imports this module too.
    from scipy import special

    position, time_s = steps.position[1:][groups.there], steps.plateaus.middle_s[1:][groups.there]
    mean_s = groups.means(time_s)
    from_mean_s = time_s - mean_s[groups.of]
    dof = position.size - groups.counts().size - 1
    square = float(from_mean_s @ from_mean_s)
    slope = float(from_mean_s @ position) / square
    level = groups.means(position - slope * time_s)
    left = position - slope * time_s - level[groups.of]
    counts = groups.counts()
    shared = correlation_within(left, steps.moves.directions, groups.interior())
    variance = float(left @ left) / dof * mean_variance_factor(shared, groups.place.size)
    u_slope = math.sqrt(variance / square)
    each = 1.0 / counts[groups.forward] + 1.0 / counts[groups.backward]
    lag_s = float(np.mean(mean_s[groups.backward] - mean_s[groups.forward]))
    u_mean = math.hypot(math.sqrt(variance * float(each.sum())) / each.size, u_slope * lag_s)
    probability = 2.0 * float(special.stdtr(dof, -abs(slope) / max(u_slope, 1e-300)))
    return level[groups.backward] - level[groups.forward], u_mean, probability


def _drift_flags(probability: float) -> list[Flag]:
    if probability >= SIGNIFICANCE:
        return []
    text = f"positions drift during the test (p = {probability:.1g}): the drift is fitted with them and taken off"
    return [Flag("drift", text)]


def _torque_flags(torque: TorqueSigns | None) -> list[Flag]:
    if torque is None:
        text = "no motor torque was recorded: whether the reversal error is lost motion of the drive is not known"
        return [Flag("torque", text)]
    if torque.late_s:
        side = "behind" if torque.late_s > 0.0 else "ahead of"
        text = (
            f"the motor torque changes some {abs(torque.late_s):.0f} s {side} the reversals, or whole sequences "
            "more: it is by another clock, or of another run, and says nothing about play; correct its times"
        )
        return [Flag("torque-clock", text)]
    if torque.change:
        return []
    text = (
        f"the motor torque does not change its sign ({torque.forward_nm:.3g} N m forwards, "
        f"{torque.backward_nm:.3g} N m backwards): the reversal error is not taken for lost motion of the drive"
    )
    return [Flag("torque", text)]
