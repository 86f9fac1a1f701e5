"""When the beam is looked at while bench time passes."""

import numpy as np

from catseye.simulators.world.types import Floats

_REST_STEP_S = 10.0
"""While nothing moves only warming changes the beam; it is looked at this often."""


class BeamSampling:
    """Times of looks: those that a motion asks for, and after its end one now and then.

    Args:
        times_s: of a motion that is over, bench times in order, s, one at least, shape (n,).
    """

    def __init__(self, times_s: Floats) -> None:
        self._times_s = times_s
        self._taken = times_s.size

    def plan(self, times_s: Floats, now_s: float) -> None:
        """Take the times that the present motion asks for; what lies before the present moment is over.

        Args:
            times_s: bench times in order, s, one at least, shape (n,).
            now_s: bench time.
        """
        self._times_s = times_s
        self._taken = int(np.searchsorted(times_s, now_s, side="right"))

    def due(self, now_s: float, until_s: float) -> Floats:
        """Return the times of looks after the present and up to a moment, in order, and take them as done."""
        upto = int(np.searchsorted(self._times_s, until_s, side="right"))
        due = self._times_s[self._taken : upto]
        self._taken = max(self._taken, upto)
        calm_s = float(self._times_s[-1])
        first = int(np.floor(max(0.0, now_s - calm_s) / _REST_STEP_S)) + 1
        last = int(np.floor(max(0.0, until_s - calm_s) / _REST_STEP_S))
        if last < first:
            return due
        return np.concatenate([due, calm_s + _REST_STEP_S * np.arange(first, last + 1)])
