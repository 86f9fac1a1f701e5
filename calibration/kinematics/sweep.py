"""Whether bodies stay clear of each other along a way, between its targets too.

All joints move together, so a way is a straight line in joint space from target to target. Within an interval the
distance of a pair differs from that at the middle by no more than the pair's levers times half the interval. An
interval is clear where the distance at its middle exceeds the clearance by this bound; otherwise it is halved.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.bodies import Gaps, Pair
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Bools, Floats, Ints

RESOLUTION_MM = 0.1
"""Where the bound is below this, a pair that cannot be shown to be clear counts as too near."""

_LOOK_MM = 2.0
_MOST_LOOKS = 1000
"""Samples along the rest of a refused leg, for the least distance that a refusal states."""

_MOST_AT_ONCE = 4096
"""Intervals that are looked at together: memory stays bounded on the longest ways."""


@dataclass(frozen=True)
class Contact:
    """Where a way comes too near.

    Attributes:
        pair: names of the two bodies that come too near first.
        distance_mm: their least distance on the rest of the leg, negative where they overlap.
        leg: number of the leg, from 0; leg k leads to target k + 1 of the way.
        pose: joints there, deg or mm.
        clear_share: share 0...1 of the leg, from its start, over which everything is clear.
    """

    pair: Pair
    distance_mm: float
    leg: int
    pose: tuple[float, ...]
    clear_share: float


@dataclass(frozen=True)
class _Intervals:
    """Parts of legs that have not been decided.

    Attributes:
        leg: number of the leg, shape (n,).
        low: share of the leg where the part begins, shape (n,).
        high: share where it ends, shape (n,).
    """

    leg: Ints
    low: Floats
    high: Floats

    @classmethod
    def whole(cls, legs: Ints) -> "_Intervals":
        """Return whole legs."""
        return cls(legs, np.zeros(len(legs)), np.ones(len(legs)))

    def select(self, rows: Bools) -> "_Intervals":
        return _Intervals(self.leg[rows], self.low[rows], self.high[rows])

    def halved(self) -> "_Intervals":
        """Return both halves of each, in order of the way."""
        middle = 0.5 * (self.low + self.high)
        low = np.column_stack([self.low, middle]).ravel()
        return _Intervals(np.repeat(self.leg, 2), low, np.column_stack([middle, self.high]).ravel())


def first_contact(
    gaps: Gaps, way: Floats, clearance_mm: float, passed: Bools | None = None
) -> Contact | None:
    """Return where a way first comes nearer than the clearance; None when it is clear.

    Args:
        way: targets, the present pose first, deg or mm, shape (n, joints).
        clearance_mm: what is kept between any two bodies.
        passed: at which targets the arm does not stand still but cuts the corner, shape (n,); None for none. It stays
            within the triangle of a target and its neighbours, so its joints are off by half their second difference
            there at most.

    Raises:
        KinematicsError: a target is not finite, or the clearance negative or no number: nothing would be too near
            then.
    """
    if not clearance_mm >= 0.0:
        raise KinematicsError(f"clearance_mm is {clearance_mm:g}: state zero or more")
    if not np.isfinite(way).all():
        raise KinematicsError("a target of the way is not finite: plan the way again")
    if not gaps.pairs:
        return None
    if len(way) == 1:
        way, passed = np.repeat(way, 2, axis=0), None
    steps = np.diff(way, axis=0)
    needed = np.full((len(gaps.pairs), len(steps)), clearance_mm)
    if passed is not None:
        needed += gaps.levers @ cut_corners(way, passed).T
    for first in range(0, len(steps), _MOST_AT_ONCE):
        legs = np.arange(first, min(first + _MOST_AT_ONCE, len(steps)))
        found = _first_blocked(gaps, way, steps, needed, legs)
        if found is not None:
            leg, share = found
            return _contact(gaps, way[leg], steps[leg], needed[:, leg], leg, share)
    return None


def clear_legs(gaps: Gaps, start: Floats, end: Floats, clearance_mm: float) -> Bools:
    """Return which of many straight legs are clear, each by itself, as `first_contact` decides it.

    Args:
        start: where they begin, deg or mm, shape (n, joints).
        end: where they end, likewise.
        clearance_mm: what is kept between any two bodies.

    Returns:
        Shape (n,).
    """
    clear = np.ones(len(start), dtype=np.bool_)
    if not gaps.pairs:
        return clear
    step = end - start
    for first in range(0, len(start), _MOST_AT_ONCE):
        todo = _Intervals.whole(np.arange(first, min(first + _MOST_AT_ONCE, len(start))))
        while todo.leg.size:
            open_, shut, hit = _looked_at(gaps, start, step, np.array(clearance_mm), todo)
            clear[todo.leg[shut | hit]] = False
            todo = todo.select(open_ & clear[todo.leg]).halved()
    return clear


def _looked_at(
    gaps: Gaps, start: Floats, step: Floats, needed: Floats, todo: _Intervals
) -> tuple[Bools, Bools, Bools]:
    """Return which intervals have to be halved, which cannot be shown to be clear, and which are blocked.

    Args:
        start: of all legs, shape (n, joints).
        step: from there to their ends, likewise.
        needed: distance that is kept on each of `todo`, broadcast against shape (pairs, intervals).
    """
    along = step[todo.leg]
    middle = start[todo.leg] + (0.5 * (todo.low + todo.high))[:, None] * along
    bound = gaps.levers @ (np.abs(along) * (0.5 * (todo.high - todo.low))[:, None]).T
    spare = gaps.at(middle) - needed
    unknown = spare < bound
    shut: Bools = np.any(unknown & (bound < RESOLUTION_MM), axis=0)
    return np.any(unknown, axis=0), shut, np.any(spare < 0.0, axis=0)


def _first_blocked(
    gaps: Gaps, way: Floats, step: Floats, needed: Floats, legs: Ints
) -> tuple[int, float] | None:
    """Return leg and share up to which everything is clear; None when all legs are."""
    todo = _Intervals.whole(legs)
    blocked: tuple[int, float] | None = None
    while todo.leg.size:
        open_, shut, hit = _looked_at(gaps, way, step, needed[:, todo.leg], todo)
        hits = np.flatnonzero(shut | hit)
        if hits.size:
            # What comes later on the way does not matter any more; what comes before may be blocked too.
            first = int(hits[0])
            open_[first + 1 :] = False
            if shut[first]:
                blocked = int(todo.leg[first]), float(todo.low[first])
                open_[first] = False
        todo = todo.select(open_).halved()
    return blocked


def cut_corners(way: Floats, passed: Bools) -> Floats:
    """Return how far the joints may be off each leg of a way whose corners are cut, deg or mm, shape (legs, joints).

    Args:
        way: targets, the present pose first, deg or mm, shape (n, joints).
        passed: at which targets the arm does not stand still, shape (n,).
    """
    bend = np.zeros_like(way)
    bend[1:-1] = 0.5 * np.abs(way[:-2] - 2.0 * way[1:-1] + way[2:])
    bend[~passed] = 0.0
    return np.maximum(bend[:-1], bend[1:])


def _contact(gaps: Gaps, start: Floats, step: Floats, needed: Floats, leg: int, share: float) -> Contact:
    """Return what there is to say about a leg that is blocked beyond a share."""
    first = int(np.argmin(gaps.at((start + share * step)[None])[:, 0] - needed))
    looks = float(gaps.levers[first] @ np.abs(step)) * (1.0 - share) / _LOOK_MM
    shares = np.linspace(share, 1.0, min(_MOST_LOOKS, 2 + int(looks)))
    poses = start + shares[:, None] * step
    distances = gaps.at(poses)[first]
    nearest = int(np.argmin(distances))
    pose = tuple(float(q) for q in poses[nearest])
    return Contact(gaps.pairs[first], float(distances[nearest]), int(leg), pose, share)
