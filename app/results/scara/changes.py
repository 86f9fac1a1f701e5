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

_KNOWN = 1e-6
"""Share of the largest variance below which nothing is known of a combination of values: rounding, or the gauge."""


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
    inverse, known = _inverse(covariance)
    found = []
    for one in patterns:
        weight = float(one.values @ inverse @ one.values)
        if weight > 0.0 and np.linalg.norm(known @ one.values) > _KNOWN:
            size = float(one.values @ inverse @ compared.difference) / weight
            found.append(Change(one.name, one.unit, size, 1.0 / math.sqrt(weight)))
    return found


def _inverse(covariance: Floats) -> tuple[Floats, Floats]:
    """Return the inverse of a covariance over the values in units of their own u, and the projection on it."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    stated = scale > 0.0
    unit = np.where(stated, 1.0 / np.where(stated, scale, 1.0), 0.0)
    variances, vectors = np.linalg.eigh(covariance * np.outer(unit, unit))
    kept = variances > _KNOWN * variances[-1]
    axes = vectors[:, kept] * unit[:, None]
    return axes / variances[kept] @ axes.T, axes @ axes.T


def largest(changes: Sequence[Change]) -> Change | None:
    """Return the change that is largest in standard uncertainties; None without any."""
    return max(changes, key=lambda one: abs(one.normalised), default=None)


def beyond(changes: Sequence[Change], limit_u: float | None) -> list[Change]:
    """Return the changes beyond a limit in standard uncertainties, the largest first; none without a limit."""
    found = [one for one in changes if limit_u is not None and abs(one.normalised) > limit_u]
    return sorted(found, key=lambda one: -abs(one.normalised))
