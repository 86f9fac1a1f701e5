"""Links that warm because the arm moves: heat by duty and speed, a first-order response, and cooling at rest."""

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.simulators.config import Joints
from catseye.simulators.world.motion import SHORTEST, Motion
from catseye.simulators.world.types import Floats

SLOW_HEAT: Final = 0.5
"""Heat of drives that barely move, as a part of that at full speed: friction of gears hardly depends on speed, while
losses in oil and motors do; an assumption."""

_KEPT: Final = 1024
"""Motions that are remembered, for instruments that look back; more than any arm remembers."""


@dataclass(frozen=True)
class _Section:
    """One motion and the rest that follows it.

    Attributes:
        start_s: bench time of its start.
        end_s: bench time of its end.
        heat: from start to end, 1 at full speed.
        level: warmth at the start.
    """

    start_s: float
    end_s: float
    heat: float
    level: float


class Warming:
    """How warm the links are: 0 as they were at the start, 1 after hours of motion at full speed without a pause.

    Args:
        fastest: largest speed of each joint, deg/s or mm/s.
        growth_ppm: what links are longer at a warmth of 1.
        time_constant_s: of warming and of cooling.
    """

    def __init__(self, fastest: Joints, growth_ppm: float = 0.0, time_constant_s: float = 3600.0) -> None:
        self.growth_ppm = growth_ppm
        self._time_constant_s = time_constant_s
        self._fastest = np.array(fastest)
        self._sections = deque([_Section(0.0, 0.0, 0.0, 0.0)], maxlen=_KEPT)

    def begin(self, motion: Motion) -> None:
        """Take note of a motion; what was left of the one before is not driven."""
        level = float(self.at(np.array([motion.start_s]))[0])
        self._sections.append(_Section(motion.start_s, motion.end_s, self._heat(motion), level))

    def set_up(self, growth_ppm: float, time_constant_s: float) -> None:
        """Have links grow otherwise, before anything has moved."""
        self.growth_ppm = growth_ppm
        self._time_constant_s = time_constant_s

    def growth(self, times_s: Floats) -> Floats:
        """Return the lengths of links at bench times in order, as parts of those at the start, same shape."""
        return np.asarray(1.0 + 1e-6 * self.growth_ppm * self.at(times_s))

    def at(self, times_s: Floats) -> Floats:
        """Return the warmth at bench times in order, s, same shape."""
        last = self._sections[-1]
        if not times_s.size or times_s[0] >= last.start_s:
            return self._within(last, times_s)
        starts_s = [section.start_s for section in self._sections]
        which = [max(0, bisect_right(starts_s, time_s) - 1) for time_s in times_s.tolist()]
        levels = [self._within(self._sections[k], times_s[n : n + 1])[0] for n, k in enumerate(which)]
        return np.array(levels)

    def _within(self, section: _Section, times_s: Floats) -> Floats:
        """Return the warmth in one section: towards its heat while the arm moves, towards 0 behind."""
        duration_s = section.end_s - section.start_s
        since_s = np.maximum(times_s - section.start_s, 0.0)
        driven = np.exp(-np.minimum(since_s, duration_s) / self._time_constant_s)
        cooled = np.exp(-np.maximum(since_s - duration_s, 0.0) / self._time_constant_s)
        return np.asarray((section.heat + (section.level - section.heat) * driven) * cooled)

    def _heat(self, motion: Motion) -> float:
        """Return the heat of a motion: by the mean speed of the joint that is nearest to its largest one."""
        duration_s = motion.profile.duration_s
        ways = np.abs(motion.steps).sum(axis=0)
        if duration_s <= 0.0 or not np.any(ways > SHORTEST):
            return 0.0
        share = float(np.max(ways / (duration_s * self._fastest)))
        return SLOW_HEAT + (1.0 - SLOW_HEAT) * min(1.0, share)
