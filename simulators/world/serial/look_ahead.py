"""Looks at a steady rate are worked out ahead, many at once: one by one each would cost as much as fifty together."""

from collections.abc import Callable, Hashable

import numpy as np

from catseye.simulators.world.serial.optics import Return
from catseye.simulators.world.types import Floats

_AHEAD = 64
_SAME_S = 1e-9
_LONGEST_STEP_S = 0.1


class LookAhead:
    """What a pure function of bench time returns at single times, from blocks of times that are expected.

    Args:
        look: the function, of times, s, shape (m,).
        state: returns what it depends on beside bench time; a block holds while it is the same.
    """

    def __init__(self, look: Callable[[Floats], Return], state: Callable[[], Hashable]) -> None:
        self._look = look
        self._state = state
        self._block_state = state()
        self._times_s: Floats = np.empty(0)
        self._block = Return(np.empty(0), np.empty(0))
        self._next = 0
        self._last_s = self._step_s = 0.0

    def at(self, time_s: float) -> Return:
        """Return the function's value at a time, shape (1,)."""
        if self._state() != self._block_state:
            self._block_state, self._times_s = self._state(), np.empty(0)
        if self._next >= self._times_s.size or abs(self._times_s[self._next] - time_s) > _SAME_S:
            self._expect(time_s)
        here = slice(self._next, self._next + 1)
        self._next += 1
        self._last_s = time_s
        return Return(self._block.length_mm[here], self._block.miss[here])

    def _expect(self, time_s: float) -> None:
        """Work out the value at a time, and at those after it that come if its rate is steady."""
        step_s = time_s - self._last_s
        steady = 0.0 < step_s < _LONGEST_STEP_S and abs(step_s - self._step_s) < _SAME_S
        self._step_s = step_s
        self._times_s = time_s + step_s * np.arange(_AHEAD if steady else 1, dtype=np.float64)
        self._block, self._next = self._look(self._times_s), 0
