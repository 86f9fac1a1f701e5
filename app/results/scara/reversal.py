"""Reversal error of a joint after ISO 230-2: the map approached upwards minus the one approached downwards."""

import numpy as np

from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.scara.result import MapTable, Result


def reversal_mdeg(table: MapTable) -> list[float]:
    """Return the reversal error at the nodes, mdeg: positive approach minus negative."""
    return [p - n for p, n in zip(table.positive_mdeg, table.negative_mdeg, strict=True)]


def u_reversal_mdeg(result: Result, joint: int) -> list[float] | None:
    """Return the standard uncertainties of the reversal error, mdeg; None without a covariance.

    Both directions share the links and the reflectors, so their estimates are correlated.

    Args:
        joint: 1 or 2.
    """
    first, second = result.theta1_map, result.theta2_map
    if result.covariance is None or first is None or second is None:
        return None
    # Order of the arm's parameters: L1, L2, J1 positive, J1 negative, J2 positive, J2 negative.
    n1, n2 = len(first.node_deg), len(second.node_deg)
    if len(result.covariance.matrix) != 2 + 2 * n1 + 2 * n2:
        return None
    start, size = (2, n1) if joint == 1 else (2 + 2 * n1, n2)
    matrix = np.array(result.covariance.matrix)
    positive = np.arange(start, start + size)
    negative = positive + size
    variance = matrix[positive, positive] + matrix[negative, negative] - 2.0 * matrix[positive, negative]
    return [float(u) for u in MDEG_PER_RAD * np.sqrt(np.maximum(variance, 0.0))]
