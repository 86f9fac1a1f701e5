"""What a joint does between the nodes of its map: a function of the command angle that is zero at every node.

A map is interpolated linearly. What its joint adds between the nodes, the ripple of a gear as a rule, is known by its
size alone: rms and band of orders. The nodes contain the ripple's values there, so its interpolation counts too: half
way between two nodes the error has the variance σ²(1 + ¼ + ¼).
"""

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.error_map import interpolate

ORDERS = np.arange(18.0, 145.0)
"""Periods in a turn among which a ripple of unknown order is spread evenly: 20° to 2.5°. So angles a few degrees
apart err on their own, and neither nodes every 20° nor any others are in step with it."""

_AT_NODE = 1e-9
"""Share of an interval by which rounding may move a command off its node."""


def between_nodes(nodes_rad: Floats, theta_rad: Floats, direction: Ints) -> Floats:
    """Return what independent unit-variance sources do to a joint's angle at commands.

    Both directions of approach have sources of their own: a gear rests on other flanks.

    Args:
        nodes_rad: nodes of the map, rad, strictly increasing; a joint without a map has nothing between its nodes.
        theta_rad: command angles inside the nodes, rad, shape (n,).
        direction: states of approach, 1 or -1, shape (n,).

    Returns:
        Effects for a ripple of rms 1, shape (n, k); e eᵀ is the covariance. k is at most the number of different
        commands between the nodes.

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    if nodes_rad.size < 2:
        return np.zeros((theta_rad.size, 0))
    commands, place = np.unique(np.column_stack([theta_rad, direction]), axis=0, return_inverse=True)
    effects = _of_commands(nodes_rad, commands[:, 0], commands[:, 1])
    off = np.any(effects != 0.0, axis=1)
    if off.sum() < effects.shape[1]:
        # Fewer commands than sources: a square root of their covariance says the same in fewer columns.
        triangle = np.asarray(np.linalg.qr(effects[off].T, mode="r"), dtype=np.float64)
        effects = np.zeros((off.size, len(triangle)))
        effects[off] = triangle.T
    return np.asarray(effects[place], dtype=np.float64)


def ripple_between_nodes(nodes_rad: Floats, theta_rad: Floats) -> Floats:
    """Return the standard deviations of what a ripple of rms 1 does at commands, shape (n,): norms of between_nodes.

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    if nodes_rad.size < 2:
        return np.zeros(theta_rad.size)
    found = interpolate(nodes_rad, theta_rad)
    below, above = 1.0 - found.alpha, found.alpha
    step = nodes_rad[found.lower + 1] - nodes_rad[found.lower]
    variance = 1.0 + below**2 + above**2 + 2.0 * below * above * _alike(step)
    variance -= 2.0 * (below * _alike(above * step) + above * _alike(below * step))
    deviation = np.sqrt(np.maximum(variance, 0.0))
    return np.where(at_nodes(nodes_rad, theta_rad), 0.0, deviation)


def different_places(nodes_rad: Floats, theta_rad: Floats, direction: Ints) -> int:
    """Return at how many different commands a joint stands between its nodes; arguments as of between_nodes."""
    if nodes_rad.size < 2:
        return 0
    off = ~at_nodes(nodes_rad, theta_rad)
    return len(np.unique(np.column_stack([theta_rad, direction])[off], axis=0))


def at_nodes(nodes_rad: Floats, theta_rad: Floats) -> Bools:
    """Return which command angles are nodes, shape (n,)."""
    alpha = interpolate(nodes_rad, theta_rad).alpha
    return np.asarray(np.minimum(alpha, 1.0 - alpha) < _AT_NODE, dtype=np.bool_)


def _of_commands(nodes_rad: Floats, theta_rad: Floats, direction: Floats) -> Floats:
    found = interpolate(nodes_rad, theta_rad)
    waves, alpha = _waves(nodes_rad), found.alpha[:, None]
    ripple = _waves(theta_rad) - (1.0 - alpha) * waves[found.lower] - alpha * waves[found.lower + 1]
    ripple[at_nodes(nodes_rad, theta_rad)] = 0.0
    return np.hstack([np.where(direction[:, None] == state, ripple, 0.0) for state in (1.0, -1.0)])


def _alike(apart_rad: Floats) -> Floats:
    """Return the correlation of a ripple at commands that far apart, mean of cos(order · angle): a Dirichlet sum."""
    half = np.where(apart_rad == 0.0, 1.0, 0.5 * apart_rad)
    first, last = ORDERS[0] - 0.5, ORDERS[-1] + 0.5
    waves = np.sin(2.0 * last * half) - np.sin(2.0 * first * half)
    return np.where(apart_rad == 0.0, 1.0, waves / (2.0 * ORDERS.size * np.sin(half)))


def _waves(angle: Floats) -> Floats:
    turns = angle[:, None] * ORDERS
    return np.asarray(np.hstack([np.cos(turns), np.sin(turns)]) / np.sqrt(ORDERS.size), dtype=np.float64)
