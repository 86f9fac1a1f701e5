"""Choosing a few of many candidates: take one out, put the best one in, until nothing improves.

Information adds up over candidates, and each criterion is convex in it. A tangent therefore bounds from below what
any candidate can reach in an exchange; only candidates whose bound beats the best value so far are worked out. The
result is that of the full search of each exchange.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import (
    require_below,
    require_count,
    require_increasing,
    require_shape,
)
from catseye.calibration.core.design.criteria import Criterion, covariances
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.types import Bools, Floats, Ints

_BATCH = 16
"""Candidates that are worked out at once; the bound is looked at again after each batch."""

_LEAST_GAIN = 1e-9
"""Relative gain below which an exchange is rounding."""


@dataclass(frozen=True)
class Pool:
    """Candidates of a design, and which of them go together.

    Attributes:
        brought: information that each brings, stacked, m candidates.
        compatible: pairs that may be chosen together, shape (m, m).
        systematic: shared errors count.
    """

    brought: Information
    compatible: Bools
    systematic: bool

    @classmethod
    def of(cls, brought: list[Information], compatible: Bools, *, systematic: bool) -> "Pool":
        """Return the pool of what each candidate brings, at least one."""
        require_count(len(brought), "candidates")
        require_shape(compatible, (len(brought), len(brought)), "compatible")
        return cls(Information.stacked(brought), compatible, systematic)

    def __len__(self) -> int:
        """Return the number of candidates."""
        return int(self.compatible.shape[0])

    def covariances(self, information: Information) -> Floats:
        """Return the covariances of information, shape (..., f, f)."""
        return covariances(information.counted(systematic=self.systematic))

    def value(self, chosen: Ints, criterion: Criterion) -> float:
        """Return the criterion of a choice."""
        return float(criterion.value(self.covariances(self.brought[chosen].total())))


@dataclass(frozen=True)
class Chosen:
    """A choice.

    Attributes:
        places: indices into the pool, increasing, shape (k,).
        value: its criterion.
    """

    places: Ints
    value: float


def exchange(pool: Pool, start: Ints, criterion: Criterion) -> Chosen:
    """Improve a choice by exchanges until none improves it.

    Args:
        start: indices of different, compatible candidates, shape (k,).

    Raises:
        ArgumentError: an index names no candidate, or one is chosen twice.
    """
    require_below(start, len(pool), "start")
    require_increasing(np.sort(start).astype(np.float64), "candidates of the start")
    chosen, value = np.array(start, dtype=np.int64), pool.value(start, criterion)
    idle, position = 0, 0
    while idle < chosen.size:
        others = np.delete(chosen, position)
        place, reached = _best_addition(pool, others, int(chosen[position]), value, criterion)
        idle = idle + 1 if place == chosen[position] else 1
        chosen[position], value = place, reached
        position = (position + 1) % chosen.size
    return Chosen(np.sort(chosen), value)


def random_start(pool: Pool, count: int, rng: np.random.Generator) -> Ints | None:
    """Return a random choice of compatible candidates, None when those drawn leave no room for another."""
    require_count(count, "count")
    chosen: list[int] = []
    free = np.ones(len(pool), dtype=np.bool_)
    for _ in range(count):
        left = np.flatnonzero(free)
        if not left.size:
            return None
        chosen.append(int(rng.choice(left)))
        free &= pool.compatible[chosen[-1]]
        free[chosen[-1]] = False
    return np.array(chosen, dtype=np.int64)


def greedy_start(pool: Pool, count: int, criterion: Criterion) -> Ints | None:
    """Return a choice to which each time the best candidate was added, None when there is no room for so many."""
    require_count(count, "count")
    chosen = np.zeros(0, dtype=np.int64)
    while chosen.size < count:
        place, _ = _best_addition(pool, chosen, -1, np.inf, criterion)
        if place < 0:
            return None
        chosen = np.append(chosen, place)
    return chosen


def _best_addition(
    pool: Pool, others: Ints, present: int, value: float, criterion: Criterion
) -> tuple[int, float]:
    """Return the candidate that goes best with others, and the value reached; the present one unless beaten.

    Args:
        present: the place to beat; -1 for none, then the first possible one stands in where all are singular.
    """
    possible = np.asarray(np.all(pool.compatible[others], axis=0), dtype=np.bool_).reshape(len(pool))
    possible[others] = False
    rest = pool.brought[others].total()
    order, bounds = _by_bound(pool, rest, np.flatnonzero(possible), present, criterion)
    for first in range(0, order.size, _BATCH):
        if bounds[first] >= value - _LEAST_GAIN * abs(value):
            break
        batch = order[first : first + _BATCH]
        reached = criterion.value(pool.covariances(rest + pool.brought[batch]))
        best = int(np.argmin(reached))
        if reached[best] < value - _LEAST_GAIN * abs(value) or (present < 0 and np.isinf(value)):
            present, value = int(batch[best]), float(reached[best])
    return present, value


def _by_bound(
    pool: Pool, rest: Information, possible: Ints, present: int, criterion: Criterion
) -> tuple[Ints, Floats]:
    """Return candidates in the order of what they could reach at best, and that bound, shape (k,) each.

    A singular choice has no tangent, and what sources take of the information is not linear in the candidates: then
    nothing is bounded.
    """
    here = pool.covariances(rest + pool.brought[present]) if present >= 0 else None
    value = np.inf if here is None else float(criterion.value(here))
    if pool.systematic or here is None or np.isinf(value):
        return possible, np.full(possible.size, -np.inf)
    gain = pool.brought.matrix.reshape(len(pool), -1) @ criterion.slope(here).ravel()
    bounds = value - (gain[possible] - gain[present])
    order = np.argsort(bounds, kind="stable")
    return possible[order], bounds[order]
