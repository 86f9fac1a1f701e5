"""Piecewise linear error maps of one joint, one table for each direction of approach (Eqs 7-9, corrected)."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import (
    require_directions,
    require_finite,
    require_increasing,
    require_shape,
)
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.errors import MapRangeError


@dataclass(frozen=True)
class Interpolation:
    """Place of angles between the nodes of a map.

    Attributes:
        lower: index of the node at or below each angle, shape (n,).
        alpha: weight of the node above, 0...1, shape (n,); the node below has 1 - alpha.
    """

    lower: Ints
    alpha: Floats


def interpolate(nodes_rad: Floats, theta_rad: Floats, *, name: str = "angle") -> Interpolation:
    """Find the bracketing nodes and weights of angles.

    Args:
        nodes_rad: nodes, rad, strictly increasing, shape (m,), m >= 2 (m = 1: constant map).
        theta_rad: command angles, rad, shape (n,).
        name: what the angle is called in an error text.

    Raises:
        MapRangeError: an angle lies outside the nodes by more than 1e-9 rad.
    """
    theta = np.asarray(theta_rad, dtype=np.float64)
    # Written so that an angle that is no number lies outside.
    outside = np.flatnonzero(~((theta >= nodes_rad[0] - 1e-9) & (theta <= nodes_rad[-1] + 1e-9)))
    if outside.size:
        raise MapRangeError(
            f"{name} {np.rad2deg(theta[outside[0]]):.4f}° of row {int(outside[0]) + 1} is outside the nodes "
            f"{np.rad2deg(nodes_rad[0]):g}°…{np.rad2deg(nodes_rad[-1]):g}°; a map is never extrapolated: "
            "add nodes that enclose it or leave the point out"
        )
    return _bracket(nodes_rad, theta)


def _bracket(nodes_rad: Floats, theta: Floats) -> Interpolation:
    if nodes_rad.size == 1:
        return Interpolation(np.zeros(theta.shape, dtype=np.int64), np.zeros(theta.shape))
    lower = np.clip(np.searchsorted(nodes_rad, theta, side="right") - 1, 0, nodes_rad.size - 2)
    alpha = (theta - nodes_rad[lower]) / (nodes_rad[lower + 1] - nodes_rad[lower])
    return Interpolation(lower.astype(np.int64), np.clip(alpha, 0.0, 1.0))


@dataclass(frozen=True)
class BidirectionalMap:
    """Angular positioning deviation of one joint at nodes, for both directions of approach.

    Attributes:
        nodes_rad: command angles of the nodes, rad, strictly increasing, shape (m,).
        positive_rad: deviation (actual minus command) when approached upwards, rad, shape (m,).
        negative_rad: the same when approached downwards, rad, shape (m,).
    """

    nodes_rad: Floats
    positive_rad: Floats
    negative_rad: Floats

    def __post_init__(self) -> None:
        require_increasing(self.nodes_rad, "nodes_rad")
        for name in ("positive_rad", "negative_rad"):
            require_shape(getattr(self, name), self.nodes_rad.shape, name)
            require_finite(getattr(self, name), name)

    def deviation(self, theta_rad: Floats, direction: Ints) -> Floats:
        """Return the deviation at command angles, rad, shape (n,).

        Args:
            theta_rad: command angles, rad, shape (n,).
            direction: state of approach, 1 or -1, shape (n,).

        Raises:
            MapRangeError: an angle lies outside the nodes.
            ArgumentError: a direction is neither 1 nor -1.
        """
        require_directions(direction, "direction")
        place = interpolate(self.nodes_rad, theta_rad)
        upper = np.minimum(place.lower + 1, self.nodes_rad.size - 1)
        table = np.where(np.asarray(direction)[..., None] > 0, self.positive_rad, self.negative_rad)
        rows = np.arange(place.lower.size)
        return (1.0 - place.alpha) * table[rows, place.lower] + place.alpha * table[rows, upper]
