"""Readings of one standstill that do not belong to the others, such as one that has lost a digit on its way."""

import statistics
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

_FEWEST: Final = 8
"""Fewer readings do not tell scatter from a reading that stands apart."""

_SHARE: Final = 5
"""One reading in so many may stand apart; where more do, all of them scatter."""

_TIMES: Final = 6.0
"""Of the range of the middle readings. Normal ones stand so far from their median in 3 of 1000 standstills of ten."""

_LEAST_MM: Final = 2e-4
"""Less moves the mean of ten by 0.02 µm at most, and may be the last digit of a counter."""


def apart(values_mm: Sequence[float]) -> list[int]:
    """Return the places of the readings that stand apart, each between readings that belong to the others.

    A jump that stays, at the beginning or the end of a standstill, is none of a single reading: there the scatter of
    all has to show it.
    """
    most = len(values_mm) // _SHARE if len(values_mm) >= _FEWEST else 0
    if not most:
        return []
    ordered, median_mm = sorted(values_mm), statistics.median(values_mm)
    limit_mm = max(_TIMES * (ordered[-1 - most] - ordered[most]), _LEAST_MM)
    found = [at for at, value_mm in enumerate(values_mm) if abs(value_mm - median_mm) > limit_mm]
    alone = all(0 < at < len(values_mm) - 1 for at in found) and all(b - a > 1 for a, b in pairwise(found))
    return found if alone and len(found) <= most else []
