"""Plateaus in a recording of lengths: where a bar stood still between two motions."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_STILL_MM: Final = 0.01
"""Change from reading to reading that still counts as standstill."""

_EDGE: Final = 0.2
"""Share of a plateau at either end that is left out: the arm still settles there."""


def plateaus(t_s: Floats, value_mm: Floats, least_s: float, still_mm: float = _STILL_MM) -> list[float]:
    """Return the means of the plateaus of a recording, in order.

    Args:
        t_s: growing, s, shape (n,).
        value_mm: shape (n,).
        least_s: shortest standstill that is a plateau.
        still_mm: largest change from one reading to the next at standstill.
    """
    moves = np.abs(np.diff(value_mm)) > still_mm
    begins = np.concatenate([[0], np.flatnonzero(moves) + 1])
    ends = np.concatenate([np.flatnonzero(moves) + 1, [len(value_mm)]])
    found = []
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        if t_s[end - 1] - t_s[begin] >= least_s:
            edge = int(_EDGE * (end - begin))
            found.append(float(value_mm[begin + edge : end - edge].mean()))
    return found
