"""The step of a counter: what readings differ by at least, and what that leaves unknown of a step."""

import math

import numpy as np

from catseye.calibration.core.types import Floats

DIFFERENCE = 1.0 / math.sqrt(6.0)
"""Standard uncertainty of the difference of two rounded readings, each uniform within a quantum (GUM F.2.2.1)."""

DITHERED = 1.0 / math.sqrt(3.0)
"""Readings that scatter by so many quanta: their noise is half a quantum, and rounding averages out in a mean."""

_SMALL = 0.01
"""Share of the differences that may be smaller than the quantum, as glitches are."""

_FEWEST = 10
_MULTIPLES = 20.0
_NEAR = 0.1
_MOST = 0.9
"""Share of the differences up to 20 quanta that are multiples; of a signal without a quantum a fifth would be."""


def quantum(position: Floats) -> float:
    """Return the smallest difference between readings of which all others are multiples; 0 where there is none.

    An angle is the arcsine of what was counted: its quanta grow by less than 1 % over ±7°, which counts as equal.

    Args:
        position: readings as they were recorded, shape (n,).
    """
    differences = np.abs(np.diff(position))
    differences = differences[differences > 0.0]
    if differences.size < _FEWEST:
        return 0.0
    smallest = float(np.quantile(differences, _SMALL, method="lower"))
    multiples = differences[differences <= _MULTIPLES * smallest] / smallest
    if np.mean(np.abs(multiples - np.round(multiples)) < _NEAR) < _MOST:
        return 0.0
    return smallest
