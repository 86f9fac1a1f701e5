"""Ranges of an arm's joints: whole turns that bring a joint into its range, and what is said of one outside."""

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.types import Bools, Floats

_ROUNDING = 1e-6
"""deg or mm beyond the end of a range that a calculated joint may lie."""


def ranges_of(chain: Chain) -> tuple[Floats, Floats]:
    """Return the smallest and the largest value of each joint, deg or mm, shape (joints,) each."""
    low, high = np.array([(joint.low, joint.high) for joint in chain.joints]).T
    return low, high


def turned_nearest(q: Floats, reference: Floats, low: Floats, high: Floats) -> tuple[Floats, Bools]:
    """Return angles by whole turns as near to a reference as their range permits, and which are in it.

    An angle of which no turn is in the range is returned beyond the end of the range that it is nearest to.

    Args:
        q: deg, any shape.
        reference: deg, broadcast against the angles, as are the ends of the range.
        low: smallest, deg.
        high: largest, deg.
    """
    turned: Floats = reference - q
    turned /= 360.0
    np.round(turned, out=turned)
    turned *= 360.0
    turned += q
    inside = within(turned, low, high)
    out = np.nonzero(~inside)
    if out[0].size:
        low, high = np.broadcast_to(low, turned.shape)[out], np.broadcast_to(high, turned.shape)[out]
        turned[out] = _brought_in(turned[out], low, high)
        inside[out] = within(turned[out], low, high)
    return turned, inside


def _brought_in(q: Floats, low: Floats, high: Floats) -> Floats:
    """Return angles outside their ranges by as many turns inside as it takes, shape (n,) as all arguments."""
    q = q + 360.0 * np.ceil(np.maximum(low - _ROUNDING - q, 0.0) / 360.0)
    q = q - 360.0 * np.ceil(np.maximum(q - high - _ROUNDING, 0.0) / 360.0)
    over = q + 360.0
    return np.where((q < low - _ROUNDING) & (over - high < low - q), over, q)


def within(q: Floats, low: Floats, high: Floats) -> Bools:
    """Return whether joints are in their ranges, but for rounding, of the broadcast shape."""
    return (q >= low - _ROUNDING) & (q <= high + _ROUNDING)


def beyond_text(chain: Chain, pose: Floats) -> str:
    """Return which joint of a pose is farthest beyond its range, shape (joints,), and by how much."""
    low, high = ranges_of(chain)
    first = int(np.argmax(np.maximum(low - pose, pose - high)))
    joint = chain.joints[first]
    unit = joint.unit
    return f"{joint.name} would be at {pose[first]:.6g} {unit}, outside {joint.low:g}…{joint.high:g} {unit}"
