"""Choosing poses by exchange: each chosen pose in turn gives way to the candidate that raises the index most.

For O1 nothing is decomposed per candidate: det(A + JᵀJ) = det(A) det(I + J A⁻¹ Jᵀ) with the few rows J of a pose, and
J A⁻¹ Jᵀ of every candidate is carried along by updates of low rank. For the other indices the slope of the index says
which candidates are worth the eigenvalues.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_count, require_shape
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.design.observability import Index, observability

_LEAST_GAIN = 1e-9
"""Relative gain below which an exchange is rounding."""

_MOST_SWEEPS = 100

_SHORTLIST = 32
"""Candidates whose eigenvalues are computed, those with the steepest slope."""

_RIDGE = 1e-9
"""Share of the mean information that makes the first choice regular while it has fewer rows than parameters."""


@dataclass(frozen=True)
class Selection:
    """Poses that were chosen.

    Attributes:
        chosen: numbers of the candidates, in growing order.
        value: of the index.
        exchanges: that the best start took.
    """

    chosen: Ints
    value: float
    exchanges: int


def select(
    rows: Floats,
    count: int,
    index: Index = "O1",
    starts: int = 5,
    seed: int = 0,
    progress: Callable[[int, int, float], None] | None = None,
    known: Floats | None = None,
) -> Selection:
    """Choose candidates.

    Args:
        rows: Jacobian of each candidate in units of its uncertainty, shape (candidates, rows, parameters).
        count: how many.
        starts: random choices to begin with; the best end is taken.
        progress: called after each start with starts done, all starts and the best value.
        known: information of each parameter that is there beforehand, shape (parameters,); none by default.

    Raises:
        InsufficientPointsError: fewer candidates than wanted, or too few poses for the parameters.
        ArgumentError: there is no such index.
    """
    require_shape(rows, (None, None, None), "rows")
    require_count(starts, "starts")
    candidates = len(rows)
    if candidates < count:
        raise InsufficientPointsError(f"{candidates} candidates for {count} poses: draw more, or allow more")
    if count < (least := fewest_poses(rows, known)):
        raise InsufficientPointsError(
            f"{count} poses give {count * _rows_per_pose(rows):.0f} rows for {rows.shape[-1]} parameters: choose at "
            f"least {least} poses"
        )
    scaled, before = _scaled(rows, known)
    improve = _by_determinant if index == "O1" else _by_slope
    found: list[Selection] = []
    for start in range(starts):
        first = np.random.default_rng([seed, start]).choice(candidates, count, replace=False)
        found.append(improve(scaled, before, first.astype(np.int64), index))
        if progress is not None:
            progress(start + 1, starts, max(one.value for one in found))
    return max(found, key=lambda one: one.value)


def fewest_poses(rows: Floats, known: Floats | None = None) -> int:
    """Return how many poses have as many rows, on the average, as parameters of which nothing is known beforehand.

    Args:
        rows: as those of `select`; zeros stand for what is not measured at a pose.
        known: likewise.
    """
    unknown = rows.shape[-1] if known is None else int(np.sum(known == 0.0))
    return max(math.ceil(unknown / _rows_per_pose(rows)), 1)


def _rows_per_pose(rows: Floats) -> float:
    return max(float(np.any(rows != 0.0, axis=-1).sum()), 1.0) / len(rows)


def growth(
    rows: Floats, counts: Ints, index: Index = "O1", seed: int = 0, known: Floats | None = None
) -> Floats:
    """Return the index against the number of poses, one start each, shape (counts,).

    Raises:
        InsufficientPointsError: as those of `select`.
    """
    return np.array([select(rows, int(count), index, 1, seed, known=known).value for count in counts])


def value_of(rows: Floats, chosen: Ints, index: Index, known: Floats | None = None) -> float:
    """Return the index of a choice; the columns are scaled as those of all candidates together."""
    return _value(*_scaled(rows, known), chosen, index)


def _scaled(rows: Floats, known: Floats | None) -> tuple[Floats, Floats]:
    """Return rows in scaled columns, and what is known beforehand in the same scale, shape (m, m)."""
    scale = _scale(rows)
    beforehand = np.zeros(rows.shape[-1]) if known is None else known / scale**2
    return rows / scale, np.diag(beforehand)


def _scale(rows: Floats) -> Floats:
    """Return the rms norm that a parameter's column has in one candidate."""
    norms = np.sqrt(np.einsum("nrp,nrp->p", rows, rows) / len(rows))
    return np.where(norms > 0.0, norms, 1.0)


def _value(scaled: Floats, known: Floats, chosen: Ints, index: Index) -> float:
    return float(observability(_information(scaled[chosen], known), len(chosen), index))


def _information(scaled: Floats, known: Floats) -> Floats:
    flat = scaled.reshape(-1, scaled.shape[-1])
    return np.asarray(flat.T @ flat + known)


def _by_determinant(scaled: Floats, known: Floats, chosen: Ints, index: Index) -> Selection:
    """Exchange for O1."""
    exchanges = 0
    for _ in range(_MOST_SWEEPS):
        before = exchanges
        state = _Determinant.of(scaled, known, chosen)
        for place in range(len(chosen)):
            best, gain = state.best_for(place)
            if gain > _LEAST_GAIN:
                state = state.exchanged(place, best)
                exchanges += 1
        chosen = state.chosen
        if exchanges == before:
            break
    chosen = np.sort(chosen)
    return Selection(chosen, _value(scaled, known, chosen, index), exchanges)


@dataclass(frozen=True)
class _Determinant:
    """A choice, the inverse of its information A, and J A⁻¹ Jᵀ of every candidate.

    Attributes:
        scaled: Jacobians of the candidates, shape (candidates, rows, m).
        inverse: A⁻¹, shape (m, m).
        seen: J A⁻¹ Jᵀ, shape (candidates, rows, rows).
        chosen: numbers of the candidates.
    """

    scaled: Floats
    inverse: Floats
    seen: Floats
    chosen: Ints

    @classmethod
    def of(cls, scaled: Floats, known: Floats, chosen: Ints) -> "_Determinant":
        information = _information(scaled[chosen], known)
        ridge = _RIDGE * np.trace(information) / len(information)
        inverse = np.linalg.inv(information + ridge * np.eye(len(information)))
        return cls(scaled, inverse, (scaled @ inverse) @ np.swapaxes(scaled, 1, 2), chosen)

    def best_for(self, place: int) -> tuple[int, float]:
        """Return the candidate that had best stand in for a chosen one, and by what the logarithm of det A grows."""
        own = self.scaled[self.chosen[place]]
        without = np.eye(len(own)) - self.seen[self.chosen[place]]
        crossed = self.scaled @ (self.inverse @ own.T)
        back = (crossed @ np.linalg.inv(without)) @ np.swapaxes(crossed, 1, 2)
        grown = np.linalg.det(np.eye(len(own)) + self.seen + back)
        grown[self.chosen] = 0.0
        best = int(np.argmax(grown))
        left = float(np.linalg.det(without))
        return best, float(np.log(max(left * grown[best], 1e-300)))

    def exchanged(self, place: int, candidate: int) -> "_Determinant":
        """Return the choice with a candidate in place of a chosen one."""
        leaving, coming = self.scaled[self.chosen[place]], self.scaled[candidate]
        chosen = self.chosen.copy()
        chosen[place] = candidate
        both = np.vstack([leaving, coming])
        signs = np.repeat([-1.0, 1.0], len(coming))
        # Woodbury for A − LᵀL + CᵀC.
        middle = np.diag(signs) + both @ self.inverse @ both.T
        half = self.inverse @ both.T
        bend = np.linalg.inv(middle)
        inverse = self.inverse - half @ bend @ half.T
        crossed = self.scaled @ half
        seen = self.seen - (crossed @ bend) @ np.swapaxes(crossed, 1, 2)
        return _Determinant(self.scaled, inverse, seen, chosen)


def _by_slope(scaled: Floats, known: Floats, chosen: Ints, index: Index) -> Selection:
    """Exchange for any index."""
    exchanges, value = 0, _value(scaled, known, chosen, index)
    for _ in range(_MOST_SWEEPS):
        before = exchanges
        for place in range(len(chosen)):
            information = _information(scaled[np.delete(chosen, place)], known)
            tried = _steepest(scaled, information, index, chosen)
            added = information + np.swapaxes(scaled[tried], 1, 2) @ scaled[tried]
            values = observability(added, len(chosen), index)
            best = int(np.argmax(values))
            if values[best] > value * (1.0 + _LEAST_GAIN):
                chosen[place], value = tried[best], float(values[best])
                exchanges += 1
        if exchanges == before:
            break
    chosen = np.sort(chosen)
    return Selection(chosen, _value(scaled, known, chosen, index), exchanges)


def _steepest(scaled: Floats, information: Floats, index: Index, chosen: Ints) -> Ints:
    """Return the candidates that raise an index most to first order, none of them chosen."""
    values, vectors = np.linalg.eigh(information)
    sigma = np.sqrt(np.maximum(values, 1e-14 * values[-1]))
    weights = np.zeros_like(sigma)
    match index:
        case "O5":
            weights = 1.0 / sigma**3
        case "O3":
            weights[:3] = 1.0
        case _:
            weights[:3], weights[-1] = 1.0 / sigma[0] ** 2, -1.0 / sigma[-1] ** 2
    along = np.einsum("crk,k->c", (scaled @ vectors) ** 2, weights)
    along[chosen] = -np.inf
    return np.argsort(along)[-_SHORTLIST:]
