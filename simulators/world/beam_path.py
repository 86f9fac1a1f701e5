"""What stands in a beam, and what dirt leaves of it."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from catseye.simulators.world.types import Bools, Floats


class BeamPath:
    """The way of a beam.

    Attributes:
        clearness: what dirt leaves of the signal, 0...1.
    """

    def __init__(self) -> None:
        self.clearness = 1.0
        self._blocked_s = (np.inf, np.inf)

    def block(self, from_s: float, until_s: float) -> None:
        """Let something stand in the beam between two bench times."""
        self._blocked_s = (from_s, until_s)

    @contextmanager
    def in_hand(self) -> Iterator[None]:
        """Let somebody hold optics in hand, so that no beam returns."""
        before_s, self._blocked_s = self._blocked_s, (-np.inf, np.inf)
        yield
        self._blocked_s = before_s

    def blocked(self, time_s: Floats) -> Bools:
        """Return whether something stands in the beam at bench times, same shape."""
        started: Bools = time_s >= self._blocked_s[0]
        ended: Bools = time_s >= self._blocked_s[1]
        return started & ~ended

    def met(self, since_s: float, until_s: float) -> bool:
        """Return whether something stood in the beam at any moment between two bench times."""
        return self._blocked_s[0] <= until_s and since_s < self._blocked_s[1]
