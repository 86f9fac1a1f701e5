"""Choosing which commands to measure: rank updates of the covariance, one small block for each command.

A command brings k rows R, one to each set of rows. Adding or removing them changes the covariance C of all
parameters, nuisances included, by Woodbury's identity: C' = C ∓ C Rᵀ (I ± R C Rᵀ)⁻¹ R C. What every command would do
to the criterion follows from k × k blocks, without a factorisation.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_count
from catseye.calibration.core.design.criteria import Criterion, covariances
from catseye.calibration.core.design.information import Rows
from catseye.calibration.core.types import Bools, Floats, Ints

_PRIOR_SHARE = 1e-10
"""Weight of a prior on the nuisances, as a share of their information: one whose commands are all left out stays
defined, and nothing is learnt from it."""

_REGULAR = 1e-6
"""A command stays where leaving it out would leave less than this share of the information in a direction."""

_LEAST_GAIN = 1e-9


@dataclass(frozen=True)
class CommandPool:
    """What each command brings.

    Attributes:
        rows: weighted rows of all parameters, wanted ones first, shape (n, k, p); zero where there is none.
        free: number of the wanted free directions.
        prior: weights of the prior of everything else, shape (p,); zero for what is wanted.
    """

    rows: Floats
    free: int
    prior: Floats

    @classmethod
    def of(cls, sets: Sequence[Rows], *, systematic: bool) -> "CommandPool":
        """Join sets of rows of the same commands; each has nuisances of its own.

        Args:
            systematic: with the sources of shared errors as unknowns of unit variance.
        """
        free = sets[0].wanted.shape[1]
        common = [np.hstack([one.wanted, one.effects]) if systematic else one.wanted for one in sets]
        shared, widths = common[0].shape[1], [one.nuisance.shape[1] for one in sets]
        rows = np.zeros((common[0].shape[0], len(sets), shared + sum(widths)))
        start = shared
        for k, (one, width) in enumerate(zip(sets, widths, strict=True)):
            rows[:, k, :shared] = common[k]
            rows[:, k, start : start + width] = one.nuisance
            start += width
        prior = _PRIOR_SHARE * np.einsum("nkp,nkp->p", rows, rows)
        prior[:free], prior[free:shared] = 0.0, 1.0
        return cls(rows, free, prior)

    def covariance(self, kept: Bools) -> Floats:
        """Return the covariance of all parameters from the commands kept, shape (p, p)."""
        rows = self.rows[kept].reshape(-1, self.rows.shape[2])
        return covariances(rows.T @ rows + np.diag(self.prior))

    def value(self, kept: Bools, criterion: Criterion) -> float:
        """Return the criterion of the commands kept."""
        return float(criterion.value(self.covariance(kept)[: self.free, : self.free]))


def choose_commands(pool: CommandPool, count: int, criterion: Criterion) -> Bools:
    """Choose commands: leave out the least useful one by one, then exchange until nothing improves.

    Args:
        pool: commands; all of them together determine what is wanted.
        criterion: what is made small: A, D or path; E is served by A, whose largest part it is.

    Returns:
        Flags of the commands kept, shape (n,). More than count where fewer would leave a parameter undetermined.

    Raises:
        ArgumentError: the count is negative or not whole.
    """
    require_count(count, "count", 0)
    kept = np.ones(len(pool.rows), dtype=np.bool_)
    while kept.sum() > count:
        worst = _least_useful(pool, kept, criterion)
        if worst < 0:
            break
        kept[worst] = False
    return _exchanged(pool, kept, criterion)


def _exchanged(pool: CommandPool, kept: Bools, criterion: Criterion) -> Bools:
    kept = kept.copy()
    while True:
        out = _least_useful(pool, kept, criterion)
        if out < 0 or kept.all():
            return kept
        without = kept.copy()
        without[out] = False
        covariance = pool.covariance(without)
        possible = np.flatnonzero(~without)
        changes = changes_with(pool, possible, covariance, criterion, 1.0)
        best = int(np.argmin(changes))
        own = changes[possible == out][0]
        if changes[best] >= own - _LEAST_GAIN * abs(own):
            return kept
        kept = without
        kept[possible[best]] = True


def _least_useful(pool: CommandPool, kept: Bools, criterion: Criterion) -> int:
    """Return the command that is missed least, -1 where none can be left out."""
    possible = np.flatnonzero(kept)
    changes = changes_with(pool, possible, pool.covariance(kept), criterion, -1.0)
    best = int(np.argmin(changes))
    return int(possible[best]) if np.isfinite(changes[best]) else -1


def changes_with(
    pool: CommandPool, rows: Ints, covariance: Floats, criterion: Criterion, sign: float
) -> Floats:
    """Return by how much the criterion changes with each command added (sign 1) or removed (sign -1), shape (m,)."""
    own = pool.rows[rows]
    sides = own @ covariance
    block = np.eye(own.shape[1]) + sign * (sides @ np.swapaxes(own, 1, 2))
    regular = np.linalg.eigvalsh(block)[:, 0] > _REGULAR
    inner = np.linalg.inv(np.where(regular[:, None, None], block, np.eye(own.shape[1])))
    wanted = sides[:, :, : pool.free]
    change = _change(criterion, covariance[: pool.free, : pool.free], wanted, inner, sign)
    return np.asarray(np.where(regular, change, np.inf), dtype=np.float64)


def _change(criterion: Criterion, covariance: Floats, wanted: Floats, inner: Floats, sign: float) -> Floats:
    """Return the change of the criterion where C turns into C - sign · Uᵀ K U.

    Args:
        covariance: C of what is wanted, shape (f, f).
        wanted: U of each command, shape (m, k, f).
        inner: K of each command, shape (m, k, k).
        sign: 1 or -1.
    """
    match criterion.name:
        case "D":
            whitened = wanted @ np.linalg.inv(covariance) @ np.swapaxes(wanted, 1, 2)
            return np.asarray(np.linalg.slogdet(np.eye(wanted.shape[1]) - sign * inner @ whitened)[1])
        case "path":
            before = ((criterion.gradient @ covariance) * criterion.gradient).sum(axis=1)
            side = wanted @ criterion.gradient.T
            after = before - sign * (side * (inner @ side)).sum(axis=1)
            return np.asarray(after.max(axis=1) - before.max())
        case _:
            return np.asarray(-sign * (inner * (wanted @ np.swapaxes(wanted, 1, 2))).sum(axis=(1, 2)))
