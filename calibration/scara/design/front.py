"""Which of many compromises are worth having."""

import numpy as np

from catseye.calibration.core.types import Bools, Floats


def pareto_front(costs: Floats) -> Bools:
    """Return which rows no other row beats: none is as good in everything and better in something, shape (n,).

    Args:
        costs: what should be small, shape (n, quantities).
    """
    as_good = np.all(costs[None, :, :] <= costs[:, None, :], axis=2)
    better = np.any(costs[None, :, :] < costs[:, None, :], axis=2)
    return np.asarray(~np.any(as_good & better, axis=1), dtype=np.bool_)
