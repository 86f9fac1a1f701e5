"""From set points to joints: a moving average, then a first-order lag of each axis. One step a cycle."""

import math
from collections import deque

from catseye.simulators.config import ArmDynamics, Joints

_REST = 1e-6
"""Below this, deg or mm, the following error is none."""

_FRICTION_PERCENT = 5.0
_WEIGHT_PERCENT = (0.0, 0.0, 20.0, 0.0)


class ServoModel:
    """Command, filtered command and what the servo makes of it.

    Args:
        here: joints at rest.
        cycle_s: of the controller, s.
        filter_s: length of the moving average, s; 0 for none.
        lags_s: time constants of the axes, s.
    """

    def __init__(self, here: Joints, cycle_s: float, filter_s: float, lags_s: Joints) -> None:
        self.command = self.filtered = here
        self._cycle_s = cycle_s
        self._weights = _weights(cycle_s, filter_s)
        self._held = deque([here] * len(self._weights), maxlen=len(self._weights))
        self._shares = [1.0 - math.exp(-cycle_s / lag_s) if lag_s > 0.0 else 1.0 for lag_s in lags_s]
        self._places = deque([here] * 3, maxlen=3)

    @property
    def settled(self) -> bool:
        """Nothing moves as long as the command stays."""
        return all(held == self.command for held in self._held) and set(self._places) == {self.command}

    def next(self) -> Joints | None:
        """Do one cycle; return where the joints are at its end, None when they stay."""
        self._held.appendleft(self.command)
        j1, j2, j3, j4 = (
            sum(weight * held[axis] for weight, held in zip(self._weights, self._held, strict=True))
            for axis in range(4)
        )
        still = all(held == self.command for held in self._held)
        self.filtered = self.command if still else (j1, j2, j3, j4)
        before = self._places[-1]
        j1, j2, j3, j4 = (
            old + share * (new - old)
            for old, new, share in zip(before, self.filtered, self._shares, strict=True)
        )
        near = all(abs(new - old) < _REST for new, old in zip(self.filtered, (j1, j2, j3, j4), strict=True))
        self._places.append(self.filtered if still and near else (j1, j2, j3, j4))
        return None if self._places[-1] == before else self._places[-1]

    def current_percent(self, dynamics: ArmDynamics) -> Joints:
        """Return motor currents, per cent of the rated ones: friction, acceleration, J3's weight."""
        j1, j2, j3, j4 = (self._current(axis, limit) for axis, limit in enumerate(dynamics.max_acceleration))
        return (j1, j2, j3, j4)

    def _current(self, axis: int, largest_acceleration: float) -> float:
        first, second, third = (place[axis] for place in self._places)
        acceleration = (third - 2.0 * second + first) / self._cycle_s**2
        friction = math.copysign(_FRICTION_PERCENT, third - second) if third != second else 0.0
        return _WEIGHT_PERCENT[axis] + friction + 100.0 * acceleration / largest_acceleration


def _weights(cycle_s: float, filter_s: float) -> list[float]:
    """Return the weight of each held set point, latest first, in an average over the filter's length."""
    if filter_s <= 0.0:
        return [1.0]
    count = math.ceil(filter_s / cycle_s - 1e-9)
    return [min(cycle_s, filter_s - n * cycle_s) / filter_s for n in range(count)]
