"""Plateaus in a recording of lengths: where a bar stood still between two motions."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_STILL_MM: Final = 0.01
"""Within which a length stays at standstill; on the way from place to place it changes by more in a second."""

_EDGE: Final = 0.2
"""Share of a plateau at either end that is left out: the arm still settles there."""


_LONGER: Final = 1.3
"""By which places that are read last longer than stops on the way."""


def plateaus(
    t_s: Floats, value_mm: Floats, least_s: float, still_mm: float = _STILL_MM, places: int | None = None
) -> list[float]:
    """Return the means of the plateaus of a recording, in order.

    A bar that is led over its sphere changes its length slowly: what tells a plateau is that the length stays
    where it is for a while, not that it changes little from one reading to the next.

    Args:
        t_s: growing, s, shape (n,).
        value_mm: shape (n,).
        least_s: shortest standstill that is a plateau.
        still_mm: largest difference between two readings of one plateau.
        places: how many are expected. Where there are more, the longest so many are taken, if they are longer by far
            than the others: an arm may stand still for a while on its way, too.
    """
    found: list[tuple[int, int]] = []
    for begin, end in _still(t_s, value_mm.tolist(), least_s, still_mm):
        if found and found[-1][1] == begin and _alike(value_mm, found[-1], (begin, end), still_mm):
            begin = found.pop()[0]
        found.append((begin, end))
    return [float(_middle(value_mm, one).mean()) for one in _standing_out(t_s, found, places)]


def _standing_out(t_s: Floats, found: list[tuple[int, int]], places: int | None) -> list[tuple[int, int]]:
    if not places or len(found) <= places:
        return found
    lasting = {one: float(t_s[one[1] - 1] - t_s[one[0]]) for one in found}
    ranked = sorted(found, key=lambda one: -lasting[one])
    if lasting[ranked[places - 1]] < _LONGER * lasting[ranked[places]]:
        return found
    return sorted(ranked[:places])


def _still(t_s: Floats, values: list[float], least_s: float, still_mm: float) -> Iterator[tuple[int, int]]:
    """Give the ranges that are long enough, each as far as it goes."""
    begin = 0
    while begin < len(values):
        end, low, high = begin + 1, values[begin], values[begin]
        while end < len(values):
            low, high = min(low, values[end]), max(high, values[end])
            if high - low > still_mm:
                break
            end += 1
        if t_s[end - 1] - t_s[begin] >= least_s:
            yield begin, end
            begin = end
        else:
            begin += 1


def _alike(value_mm: Floats, one: tuple[int, int], other: tuple[int, int], still_mm: float) -> bool:
    """Return whether two ranges without anything between them are one plateau that noise has cut."""
    apart = _middle(value_mm, one).mean() - _middle(value_mm, other).mean()
    return bool(abs(apart) <= still_mm)


def _middle(value_mm: Floats, span: tuple[int, int]) -> Floats:
    edge = int(_EDGE * (span[1] - span[0]))
    return value_mm[span[0] + edge : span[1] - edge]
