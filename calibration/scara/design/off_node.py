"""Angles between the nodes of a map: few, and at which no periodic error passes for another or for none."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.core.types import Floats

Phases = NDArray[np.complex128]

_ORDERS = np.arange(6, 201)
"""Periods in a turn that a gear may have."""

_SHARES = np.arange(0.15, 0.86, 0.01)
"""Places in an interval that are tried: near a node there is little to see."""

_ROUNDS = 3
"""After so many the angles hardly change any more."""

_WORST = 8
"""Power of the coherence that is summed over the orders: the worst ones count."""

_DECIMALS = 2


def off_node_angles(nodes_deg: Floats, count: int) -> Floats:
    """Return angles between nodes at which the phases of any periodic error differ.

    The phases of order k add up to Σ exp(i k θ): as far as they do, the angles show the error in one phase only. The
    angles start at shares of the golden section and are moved one at a time, each to the best place in its interval.

    Args:
        nodes_deg: nodes, deg, strictly increasing, at least two.
        count: how many angles.

    Returns:
        Angles, deg, shape (count,), spread evenly over the intervals, in the order of the intervals.
    """
    number = np.arange(count)
    interval = number * (nodes_deg.size - 1) // max(count, 1)
    low, width = nodes_deg[interval], np.diff(nodes_deg)[interval]
    span = _SHARES[-1] - _SHARES[0]
    golden = number * 0.5 * (np.sqrt(5.0) - 1.0) % 1.0
    angles: Floats = np.round(low + width * (_SHARES[0] + span * golden), _DECIMALS)
    for place in np.tile(number, _ROUNDS):
        others = _phases(np.delete(angles, place)).sum(axis=1)
        tried = np.round(low[place] + width[place] * _SHARES, _DECIMALS)
        coherence = np.abs(others[:, None] + _phases(tried)) ** _WORST
        angles[place] = tried[int(np.argmin(coherence.sum(axis=0)))]
    return angles


def _phases(angles_deg: Floats) -> Phases:
    """Return exp(i k θ), shape (orders, angles)."""
    return np.asarray(np.exp(1j * np.multiply.outer(_ORDERS, np.deg2rad(angles_deg))), dtype=np.complex128)
