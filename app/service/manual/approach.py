"""How long a joint that is jogged may go on before it has to be stopped ahead of the cell's limit; pure."""

from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

STOP_S = 0.2
"""From the decision to stop until standstill, as the way at full speed: request, deceleration."""

MARGIN_DEG = 1.0
"""What is left to the limit at standstill, at least."""

_LOOKS = 4
"""Angles from which a speed is taken: the ramp up is over after so many."""

_DOUBT = 2.0
"""A joint may go faster next than it was seen to go."""

_MOVED_DEG = 0.02


@dataclass
class Approach:
    """One joint on its way to a limit.

    Attributes:
        limits_deg: lowest and highest angle that the cell and the bodies in the way allow.
        direction: which way.
        fastest_deg_s: what the joint cannot go beyond; believed until its own speed has been seen.
    """

    limits_deg: tuple[float, float]
    direction: Literal[-1, 1]
    fastest_deg_s: float
    _seen: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=_LOOKS))

    def free_s(self, time_s: float, angle_deg: float) -> float:
        """Take an angle; return how long after it the joint may go on, s; it has to be seen again before.

        Args:
            time_s: when it was asked for: the answer is older than its arrival.
            angle_deg: the joint.

        Returns:
            Zero or less when the joint has to be stopped now.
        """
        if not self._moves(angle_deg):
            self._seen.clear()
        self._seen.append((time_s, angle_deg))
        return (self.left_deg(angle_deg) - MARGIN_DEG) / self._speed_deg_s() - STOP_S

    def left_deg(self, angle_deg: float) -> float:
        """Return the way to the limit, deg; negative beyond it."""
        low, high = self.limits_deg
        return high - angle_deg if self.direction > 0 else angle_deg - low

    def shorten(self, end_deg: float) -> None:
        """Take another angle for the limit that the joint is on its way to."""
        low, high = self.limits_deg
        self.limits_deg = (low, end_deg) if self.direction > 0 else (end_deg, high)

    def _moves(self, angle_deg: float) -> bool:
        return bool(self._seen) and abs(angle_deg - self._seen[-1][1]) > _MOVED_DEG

    def _speed_deg_s(self) -> float:
        """Return the speed to reckon with: twice the fastest that was seen, once it is steady."""
        if len(self._seen) < _LOOKS:
            return self.fastest_deg_s
        rates = [abs(b - a) / max(t - s, 1e-3) for (s, a), (t, b) in pairwise(self._seen)]
        return min(self.fastest_deg_s, _DOUBT * max(rates))
