"""What a joint does between the nodes of its map: a function of the command angle that is zero at every node.

A map is interpolated linearly. What its joint adds between the nodes, the ripple of a gear as a rule, is known by its
size alone: rms and band of orders. The nodes contain the ripple's values there, so its interpolation counts too: half
way between two nodes the error has the variance σ²(1 + ¼ + ¼).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.error_map import interpolate

ORDERS = np.arange(18.0, 145.0)
"""Periods in a turn among which a ripple of unknown order is spread evenly: 20° to 2.5°. So angles a few degrees
apart err on their own, and neither nodes every 20° nor any others are in step with it."""

_AT_NODE = 1e-9
"""Share of an interval by which rounding may move a command off its node."""


_MOST_PLACES = 100
"""Places between the nodes of a joint beyond which a measurement is a scan: a plan has a few on purpose."""


@dataclass(frozen=True)
class Places:
    """Different commands of a joint between its nodes; both directions of approach have a ripple of their own.

    A gear rests on other flanks in each direction.

    Attributes:
        nodes_rad: nodes of the map, rad, strictly increasing; a joint without a map has nothing between its nodes.
        commands: angle, rad, and direction of each, sorted, shape (k, 2).
    """

    nodes_rad: Floats
    commands: Floats

    @classmethod
    def of(cls, nodes_rad: Floats, theta_rad: Floats, direction: Ints) -> "Places":
        """Find those among commands; angles and states of approach, 1 or -1, have shape (n,).

        Raises:
            MapRangeError: a command lies outside the nodes.
        """
        if nodes_rad.size < 2:
            return cls(nodes_rad, np.zeros((0, 2)))
        off = ~at_nodes(nodes_rad, theta_rad)
        return cls(nodes_rad, np.unique(np.column_stack([theta_rad, direction])[off], axis=0))

    def __len__(self) -> int:
        """Return their number."""
        return len(self.commands)

    def joined(self, other: "Places") -> "Places":
        """Return these places and others of the same joint."""
        return Places(self.nodes_rad, np.unique(np.vstack([self.commands, other.commands]), axis=0))

    def effects(self, theta_rad: Floats, direction: Ints) -> Floats:
        """Return what independent unit-variance sources do to the joint's angle at some of the places or at nodes.

        Returns:
            Effects for a ripple of rms 1, shape (n, m); e eᵀ is the covariance. m is at most the number of places,
            and the same sources act wherever these places are asked.
        """
        effects = np.zeros((theta_rad.size, self._effects.shape[1]))
        if len(self):
            off = ~at_nodes(self.nodes_rad, theta_rad)
            asked = np.vstack([self.commands, np.column_stack([theta_rad, direction])[off]])
            place = np.unique(asked, axis=0, return_inverse=True)[1].ravel()[len(self) :]
            effects[off] = self._effects[place]
        return effects

    @cached_property
    def _effects(self) -> Floats:
        """Effects at the places, shape (k, m)."""
        if not len(self):
            return np.zeros((0, 0))
        effects = _of_commands(self.nodes_rad, self.commands[:, 0], self.commands[:, 1])
        if len(effects) >= effects.shape[1]:
            return effects
        # Fewer commands than sources: a square root of their covariance says the same in fewer columns.
        return np.asarray(np.linalg.qr(effects.T, mode="r"), dtype=np.float64).T


@dataclass(frozen=True)
class MeasuredPlaces:
    """Where both joints stood between their nodes during a measurement."""

    joints: tuple[Places, Places]

    @property
    def average_out(self) -> bool:
        """A joint stood at so many places that what lies between its nodes averages out, as over a scan."""
        return any(len(places) > _MOST_PLACES for places in self.joints)

    def joined(self, other: "MeasuredPlaces") -> "MeasuredPlaces":
        """Return these places and others; once so many that they average out, no more are kept."""
        if self.average_out:
            return self
        (one, two), (further_one, further_two) = self.joints, other.joints
        return MeasuredPlaces((one.joined(further_one), two.joined(further_two)))


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


def at_nodes(nodes_rad: Floats, theta_rad: Floats) -> Bools:
    """Return which command angles are nodes, shape (n,)."""
    alpha = interpolate(nodes_rad, theta_rad).alpha
    return np.asarray(np.minimum(alpha, 1.0 - alpha) < _AT_NODE, dtype=np.bool_)


def _of_commands(nodes_rad: Floats, theta_rad: Floats, direction: Floats) -> Floats:
    found = interpolate(nodes_rad, theta_rad)
    waves, alpha = _waves(nodes_rad), found.alpha[:, None]
    ripple = _waves(theta_rad) - (1.0 - alpha) * waves[found.lower] - alpha * waves[found.lower + 1]
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
