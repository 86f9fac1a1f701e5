"""Set points along a way: from rest to rest, speed and acceleration of every joint within its bounds. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.melfa.mxt.lag import NO_DELAYS
from catseye.drivers.roles.pose import Pose

Floats = NDArray[np.float64]

_NOTHING = 1e-9
"""Ways of less than this, deg or mm, are none."""


@dataclass(frozen=True)
class Bounds:
    """What each joint may do: deg/s and deg/s², J3 mm/s and mm/s²."""

    speed: Pose
    acceleration: Pose


class WayProfile:
    """Speed along a way through targets, which counts one from each target to the next.

    The speed rises and falls as a squared sine, so that the acceleration has no steps. Between targets the joints
    move linearly with the way.

    Args:
        bounds: of every joint.
    """

    def __init__(self, start: Pose, way: Sequence[Pose], bounds: Bounds) -> None:
        knots = np.array([start, *way], dtype=np.float64)
        steps = np.abs(np.diff(knots, axis=0))
        keep = np.append(True, steps.max(axis=1) > _NOTHING)
        self._knots = knots[keep]
        self._length = float(len(self._knots) - 1)
        largest = np.max(np.abs(np.diff(self._knots, axis=0)), axis=0, initial=0.0)
        moving = largest > _NOTHING
        speeds = np.asarray(bounds.speed)[moving] / largest[moving]
        accelerations = np.asarray(bounds.acceleration)[moving] / largest[moving]
        self._speed = float(speeds.min(initial=math.inf))
        acceleration = float(accelerations.min(initial=math.inf))
        # A squared sine peaks at pi/2 of its mean acceleration.
        if self._length:
            self._speed = min(self._speed, math.sqrt(2.0 * acceleration * self._length / math.pi))
            self._ramp_s = 0.5 * math.pi * self._speed / acceleration
            self._flat_s = max(0.0, self._length / self._speed - self._ramp_s)
        else:
            self._ramp_s = self._flat_s = 0.0

    @property
    def duration_s(self) -> float:
        """From standstill to standstill, s."""
        return 2.0 * self._ramp_s + self._flat_s

    def set_points(self, cycle_s: float, delays_s: Pose = NO_DELAYS) -> list[Pose]:
        """Return the joints at the end of each cycle; the last one is the last target.

        Args:
            delays_s: by how much each joint goes the same way later, 0 or above.
        """
        count = math.ceil((self.duration_s + max(delays_s)) / cycle_s) if self._length else 0
        times = np.arange(1, count + 1) * cycle_s
        numbers = np.arange(len(self._knots), dtype=np.float64)
        columns = [
            np.interp(
                self._travelled(np.clip(times - delay_s, 0.0, self.duration_s)), numbers, self._knots[:, axis]
            )
            for axis, delay_s in enumerate(delays_s)
        ]
        return list(zip(*(column.tolist() for column in columns), strict=True))

    def _travelled(self, time_s: Floats) -> Floats:
        rising = self._ramp_way(np.clip(time_s, 0.0, self._ramp_s))
        flat = self._speed * np.clip(time_s - self._ramp_s, 0.0, self._flat_s)
        left = self._ramp_way(np.clip(self.duration_s - time_s, 0.0, self._ramp_s))
        whole = 0.5 * self._speed * self._ramp_s
        return np.minimum(rising + flat + (whole - left), self._length)

    def _ramp_way(self, time_s: Floats) -> Floats:
        if not self._ramp_s:
            return np.zeros_like(time_s)
        turn = math.pi / self._ramp_s
        return 0.5 * self._speed * (time_s - np.sin(turn * time_s) / turn)


def excess(points: Sequence[Pose], start: Pose, way: Sequence[Pose], bounds: Bounds, cycle_s: float) -> str:
    """Return what forbids set points: a joint outside of what its way spans, or too fast; empty when nothing does.

    Whoever let the way pass has looked at its targets, so a joint that stays between them stays within its limits.

    Args:
        start: where the arm stands.
        way: targets that were let pass.
    """
    knots = np.array([start, *way], dtype=np.float64)
    sent = np.array([start, *points], dtype=np.float64)
    low, high = knots.min(axis=0), knots.max(axis=0)
    outside = np.maximum(low - sent, sent - high).max(axis=0)
    steps = np.abs(np.diff(sent, axis=0)).max(axis=0, initial=0.0)
    fast = steps - np.asarray(bounds.speed) * cycle_s
    for joint, (out, over) in enumerate(zip(outside.tolist(), fast.tolist(), strict=True), start=1):
        if not out <= _NOTHING:
            return f"a set point of J{joint} lies {out:.3g} outside of its way"
        if not over <= _NOTHING:
            return f"a set point of J{joint} is {over:.3g} too far from the one before"
    return ""
