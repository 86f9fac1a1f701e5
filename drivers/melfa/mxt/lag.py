"""How long each joint follows its set points behind, learned from ways as they were driven. Pure.

A lag that all joints share only delays the motion. Where the lags differ, the joints are at different places of the
way at one moment, and a beam that the last joint aims misses. So joints that follow sooner get their set points later
by the difference: the slowest joint leads.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose

Floats = NDArray[np.float64]

NO_DELAYS: Pose = (0.0, 0.0, 0.0, 0.0)

_LONGEST_S = 0.2
"""A joint that is farther behind than this does not follow: nothing is learned from it."""

_KNOWN_TO_S = 1e-4
"""A lag counts once its standard uncertainty is below this."""

_LEAST_TRAVEL = 0.5
"""From ways of less than this, deg or mm, nothing is learned: little but noise would speak."""

_LEAST_SCATTER = 1e-8
"""deg² or mm²: no feedback is finer, and one that only repeats what was sent does not outweigh all others."""

_ROUNDS = 4
_JOINTS = 4


class WayTrace:
    """Set points of one way, a cycle each, and where the encoders were when they were taken."""

    def __init__(self) -> None:
        self._sent: list[Pose] = []
        self._feedback: list[Pose] = []
        self._broken = False

    def add(self, sent: Pose, feedback: Pose, cycles_missed: int) -> None:
        """Take one cycle.

        Args:
            cycles_missed: cycles of the controller before it that had no set point.
        """
        self._broken |= cycles_missed != 0
        self._sent.append(sent)
        self._feedback.append(feedback)

    def lose(self) -> None:
        """Take note of an answer that did not come: the cycles are not known any more."""
        self._broken = True

    def joint(self, number: int) -> tuple[Floats, Floats] | None:
        """Return set points and feedback of a joint, counted from 0, shape (n,) each; None where any are missing."""
        if self._broken or not self._sent:
            return None
        return (
            np.array([pose[number] for pose in self._sent]),
            np.array([pose[number] for pose in self._feedback]),
        )


@dataclass(frozen=True)
class Lag:
    """What one way, or several, say of a joint.

    Attributes:
        lag_s: from a set point to the feedback that shows it, s.
        weight: sum of the squared speeds over the squared scatter of the feedback, 1/s².
    """

    lag_s: float
    weight: float

    @property
    def u_s(self) -> float:
        """Standard uncertainty, s."""
        return 1.0 / math.sqrt(self.weight)

    def with_another(self, other: "Lag") -> "Lag":
        """Return the weighted mean of both."""
        weight = self.weight + other.weight
        return Lag((self.weight * self.lag_s + other.weight * other.lag_s) / weight, weight)


def lag_of(sent: Floats, feedback: Floats, cycle_s: float) -> Lag | None:
    """Return the lag of a joint over one way: the shift in time by which its set points fit the feedback best.

    Between the cycles the set points are taken as straight, before the first one as at rest where the way began.

    Args:
        sent: set points, one a cycle, from standstill to standstill, shape (n,).
        feedback: of the same cycles, shape (n,).

    Returns:
        None where the joint travelled too little, or does not follow.
    """
    if np.ptp(sent) < _LEAST_TRAVEL:
        return None
    times_s = cycle_s * np.arange(sent.size, dtype=np.float64)
    speed = np.gradient(sent, cycle_s)
    lag_s = information = 0.0
    left = sent - feedback
    for _ in range(_ROUNDS):
        moved = np.interp(times_s - lag_s, times_s, speed)
        left = np.interp(times_s - lag_s, times_s, sent) - feedback
        information = float(moved @ moved)
        if not information:
            return None
        lag_s += float(moved @ left) / information
        if not 0.0 <= lag_s <= _LONGEST_S:
            return None
    scatter = float(np.mean(np.square(left)))
    return Lag(lag_s, information / max(scatter, _LEAST_SCATTER))


class LagLearner:
    """Keeps what the ways of one connection have shown.

    Args:
        cycle_s: of the controller.
        most_s: largest difference between two joints that is plausible; 0 switches the lead off.
    """

    def __init__(self, cycle_s: float, most_s: float) -> None:
        self._cycle_s = cycle_s
        self._most_s = most_s
        self._lags: list[Lag | None] = [None] * _JOINTS

    def take(self, trace: WayTrace) -> None:
        """Learn from a way that was driven to its end."""
        for number, known in enumerate(self._lags):
            joint = trace.joint(number)
            new = None if joint is None else lag_of(*joint, self._cycle_s)
            if new is not None:
                self._lags[number] = new if known is None else known.with_another(new)

    @property
    def lags_s(self) -> tuple[float | None, ...]:
        """Lag of each joint, s; None where it is not known well enough."""
        return tuple(None if lag is None or lag.u_s > _KNOWN_TO_S else lag.lag_s for lag in self._lags)

    @property
    def difference_s(self) -> float:
        """Largest difference of two known lags, s."""
        known = _known(self.lags_s)
        return max(known) - min(known) if known else 0.0

    @property
    def plausible(self) -> bool:
        """The lags differ by no more than they may."""
        return self.difference_s <= self._most_s

    @property
    def delays_s(self) -> Pose:
        """How much later than the slowest joint each one gets its set points, s, 0 or above; all 0 while unknown.

        A joint that has not shown its lag is taken for an average one.
        """
        known = _known(self.lags_s)
        if len(known) < 2 or not self.plausible:
            return NO_DELAYS
        slowest_s, usual_s = max(known), sum(known) / len(known)
        j1, j2, j3, j4 = (slowest_s - (usual_s if lag is None else lag) for lag in self.lags_s)
        return (j1, j2, j3, j4)


def _known(lags_s: Sequence[float | None]) -> list[float]:
    return [lag_s for lag_s in lags_s if lag_s is not None]
