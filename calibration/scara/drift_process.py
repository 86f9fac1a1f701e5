"""Errors that change with time, as a process: functions of the share of the measurement that has passed.

A drift has no known form. Cosines over the measurement, of uncorrelated sizes that fall with the square of their
order as those of a random walk do, describe what has no steps (Karhunen and Loève). They are level at both ends,
though, and a steady drift would take all the odd ones: a straight line takes the place of the first. How fast a drift
really changes is not known beforehand, so octaves of orders have sizes of their own, which distances show. The mean
over the measurement is none of its business: zeros and links are what they are on the average.
"""

import numpy as np

from catseye.calibration.core.budget import harmonics
from catseye.calibration.core.types import Floats, Ints


def octaves(orders: int) -> Ints:
    """Return the octave that each order 1…orders belongs to, from 0: 1; 2, 3; 4 to 7; …, shape (orders,)."""
    return np.array([order.bit_length() - 1 for order in range(1, orders + 1)], dtype=np.int64)


def shares(orders: int) -> Floats:
    """Return what orders 1…orders give to the variance as stated; they add up to 1, shape (orders,)."""
    falling = 1.0 / np.arange(1.0, orders + 1.0) ** 2
    return np.asarray(falling / falling.sum())


def courses(elapsed: Floats, orders: int) -> Floats:
    """Return a straight line and the cosines from order 2, of rms 1 over the measurement.

    Args:
        elapsed: share of the measurement that has passed, −½…½, shape (n,).

    Returns:
        One column an order, shape (n, orders).
    """
    columns = np.sqrt(2.0) * harmonics(np.pi * (elapsed + 0.5), orders)[:, ::2]
    columns[:, 0] = -np.sqrt(12.0) * elapsed
    return np.asarray(columns, dtype=np.float64)
