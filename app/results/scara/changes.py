"""What has changed of an arm between two results: one link or node at a time, judged with the whole covariance.

Most of what makes a map uncertain moves many nodes together, or comes again in the second measurement. What a single
node deviates from all others by is far better known, and that is where a change of one node shows. For a change of
one link or node alone, generalised least squares give its size and standard uncertainty from the difference d and its
covariance C: (eᵀ C⁻ d) / (eᵀ C⁻ e) and 1 / √(eᵀ C⁻ e), with e the pattern of the change in the gauge of the
comparison.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.results.scara.shared_errors import SharedErrors
from catseye.calibration.core.types import Floats

_ROUNDED = 1e-6
"""Share of the largest variance that every combination has at least: so many digits of results are stored."""

_GAUGE = 1e-9
"""Share of the largest singular value below which no parameter reaches a combination: the gauge takes it."""


@dataclass(frozen=True)
class Change:
    """A change of one link or node alone that the difference would come from.

    Attributes:
        name: of what changes.
        unit: of value and u.
        value: the size of the change.
        u: its standard uncertainty.
    """

    name: str
    unit: str
    value: float
    u: float

    @property
    def normalised(self) -> float:
        """The change in standard uncertainties."""
        return self.value / self.u


@dataclass(frozen=True)
class Pattern:
    """What a change of one link or node by 1 does to the compared values.

    Attributes:
        name: of what changes.
        unit: of the change.
        values: in the gauge of the comparison, shape (n,).
    """

    name: str
    unit: str
    values: Floats


@dataclass(frozen=True)
class Compared:
    """Values of both results that are compared.

    Attributes:
        difference: second minus first, shape (n,).
        weights: what the parameters of either arm contribute to them, shapes (n, p) and (n, q).
    """

    difference: Floats
    weights: tuple[Floats, Floats]


def changes_of(
    compared: Compared,
    patterns: Iterable[Pattern],
    covariances: tuple[Floats, Floats],
    shared: SharedErrors,
) -> list[Change]:
    """Return for each pattern the size at which it alone would explain the difference best.

    Args:
        covariances: of the parameters of either arm.
        shared: errors that are the same in both.

    Returns:
        Those of which anything is known.
    """
    first, second = compared.weights
    crossed = sum(
        ((first @ one) @ (second @ other).T for one, other in shared.taken_up),
        np.zeros((compared.difference.size,) * 2),
    )
    covariance = first @ covariances[0] @ first.T + second @ covariances[1] @ second.T - crossed - crossed.T
    inverse, seen = _inverse(covariance, np.hstack(compared.weights))
    found = []
    for one in patterns:
        weight = float(one.values @ inverse @ one.values)
        if weight > 0.0 and np.linalg.norm(seen @ one.values) > _GAUGE:
            size = float(one.values @ inverse @ compared.difference) / weight
            found.append(Change(one.name, one.unit, size, 1.0 / math.sqrt(weight)))
    return found


def _inverse(covariance: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Return the inverse of a covariance where the gauge leaves something to see, and how to see it.

    Args:
        weights: what all parameters contribute to the values, shape (n, p).

    Returns:
        The inverse, shape (n, n); the values in units of their own u, without what the gauge takes, shape (m, n).
    """
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    stated = scale > 0.0
    unit = np.where(stated, 1.0 / np.where(stated, scale, 1.0), 0.0)
    reached = weights * unit[:, None]
    lengths = np.linalg.norm(reached, axis=0)
    vectors, sizes, _ = np.linalg.svd(reached / np.where(lengths > 0.0, lengths, 1.0), full_matrices=False)
    seen = vectors[:, sizes > _GAUGE * sizes[0]].T * unit
    variances, axes = np.linalg.eigh(seen @ covariance @ seen.T)
    axes = axes.T @ seen
    return axes.T / np.maximum(variances, _ROUNDED * variances[-1]) @ axes, seen


def largest(changes: Sequence[Change]) -> Change | None:
    """Return the change that is largest in standard uncertainties; None without any."""
    return max(changes, key=lambda one: abs(one.normalised), default=None)


def beyond(changes: Sequence[Change], limit_u: float | None) -> list[Change]:
    """Return the changes beyond a limit in standard uncertainties, the largest first; none without a limit."""
    found = [one for one in changes if limit_u is not None and abs(one.normalised) > limit_u]
    return sorted(found, key=lambda one: -abs(one.normalised))
