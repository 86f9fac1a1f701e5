"""How long a joint that is jogged may go on before it has to be stopped ahead of the cell's limit; pure."""

from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

STOP_S = 0.2
"""From the decision to stop until standstill, as the way at full speed: request, deceleration."""

MARGIN = 1.0
"""What is left to the limit at standstill, at least, deg or mm."""

_LOOKS = 4
"""Looks from which a speed is taken: the ramp up is over after so many."""

_DOUBT = 2.0
"""A joint may go faster next than it was seen to go."""

_MOVED = 0.02


@dataclass
class Approach:
    """One joint on its way to a limit.

    Attributes:
        limits: lowest and highest value that the cell and the bodies in the way allow.
        direction: which way.
        fastest: what the joint cannot go beyond, deg/s or mm/s; believed until its own speed has been seen.
    """

    limits: tuple[float, float]
    direction: Literal[-1, 1]
    fastest: float
    _seen: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=_LOOKS))

    def free_s(self, time_s: float, value: float) -> float:
        """Take a value; return how long after it the joint may go on, s; it has to be seen again before.

        Args:
            time_s: when it was asked for: the answer is older than its arrival.

        Returns:
            Zero or less when the joint has to be stopped now.
        """
        if not self._moves(value):
            self._seen.clear()
        self._seen.append((time_s, value))
        return (self.left(value) - MARGIN) / self._speed() - STOP_S

    def left(self, value: float) -> float:
        """Return the way to the limit, deg or mm; negative beyond it."""
        low, high = self.limits
        return high - value if self.direction > 0 else value - low

    def shorten(self, end: float) -> None:
        """Take another value for the limit that the joint is on its way to."""
        low, high = self.limits
        self.limits = (low, end) if self.direction > 0 else (end, high)

    def _moves(self, value: float) -> bool:
        return bool(self._seen) and abs(value - self._seen[-1][1]) > _MOVED

    def _speed(self) -> float:
        """Return the speed to reckon with: twice the fastest that was seen, once it is steady."""
        if len(self._seen) < _LOOKS:
            return self.fastest
        rates = [abs(b - a) / max(t - s, 1e-3) for (s, a), (t, b) in pairwise(self._seen)]
        return min(self.fastest, _DOUBT * max(rates))
