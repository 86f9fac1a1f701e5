"""Rows whose errors have parts in common, made independent: generalised least squares as ordinary least squares.

In units of their white standard uncertainties the rows' errors have the covariance V = I + F Fᵀ, with F the weighted
effects of sources of unit variance. V differs from I in few directions, so its roots cost a matrix of sources by
sources (Woodbury). The symmetric root V^(-1/2) changes the rows as little as any root can: a whitened row is still
that row.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import Shared, stacked
from catseye.calibration.core.types import Floats

_SQUARED = 1e8
"""Sources whose effects, squared, add up to more would hide their own unit variance: half of the digits are lost."""


@dataclass(frozen=True)
class Whitening:
    """What turns rows in mm into rows whose errors are independent and of unit variance.

    Attributes:
        weights: reciprocal white standard uncertainties, 1/mm, shape (n,).
        effects: weighted effects F of m shared sources, shape (n, m).
    """

    weights: Floats
    effects: Floats

    @classmethod
    def of(cls, weights: Floats, shared: Sequence[Shared] = ()) -> "Whitening":
        """Prepare rows; weights are those of their white errors, 1/mm, shape (n,)."""
        return cls(weights, stacked(shared, weights.size) * weights[:, None])

    @cached_property
    def _sources(self) -> Floats:
        """Return FᵀF, shape (m, m)."""
        return np.asarray(self.effects.T @ self.effects, dtype=np.float64)

    @cached_property
    def _core(self) -> Floats:
        """Return K with V^(-1/2) = I − F K Fᵀ, shape (m, m)."""
        values, vectors = linalg.eigh(self._sources, check_finite=False)
        root = np.sqrt(1.0 + np.maximum(values, 0.0))
        return np.asarray((vectors / (root * (root + 1.0))) @ vectors.T, dtype=np.float64)

    @cached_property
    def _triangle(self) -> Floats:
        """Return the lower triangle R of I + FᵀF = R Rᵀ, shape (m, m)."""
        identity = np.eye(len(self._sources))
        if np.max(np.diag(self._sources), initial=0.0) < _SQUARED:
            return np.asarray(linalg.cholesky(self._sources + identity, lower=True, check_finite=False))
        upper = linalg.qr(np.vstack([self.effects, identity]), mode="r", check_finite=False)[0]
        return np.asarray(upper[: len(identity)].T, dtype=np.float64)

    @cached_property
    def reach(self) -> Floats:
        """A with V⁻¹ = I − A Aᵀ: what the shared sources take of a row, shape (n, m)."""
        taken = linalg.solve_triangular(self._triangle, self.effects.T, lower=True, check_finite=False)
        return np.asarray(taken.T, dtype=np.float64)

    def rows(self, columns_mm: Floats) -> Floats:
        """Return whitened columns, V^(-1/2) W times columns of shape (n,) or (n, k)."""
        return self.again((columns_mm.T * self.weights).T)

    def again(self, weighted: Floats) -> Floats:
        """Return V^(-1/2) times weighted columns of shape (n,) or (n, k); twice it is V⁻¹."""
        if not self.effects.shape[1]:
            return weighted
        along = self._core @ (self.effects.T @ weighted)
        return np.asarray(weighted - self.effects @ along, dtype=np.float64)

    def forces(self, columns_mm: Floats) -> Floats:
        """Return the inverse of the rows' covariance times columns in mm, of shape (n,) or (n, k)."""
        weighted = (columns_mm.T * self.weights).T
        if self.effects.shape[1]:
            weighted -= self.effects @ self._sources_behind(weighted)
        return np.asarray((weighted.T * self.weights).T, dtype=np.float64)

    def square(self, residuals_mm: Floats) -> float:
        """Return the sum of squares of the whitened residuals, of shape (n,).

        It is what is left beside the likeliest sources, and these: nothing that is large cancels.
        """
        weighted = residuals_mm * self.weights
        if not self.effects.shape[1]:
            return float(weighted @ weighted)
        sources = self._sources_behind(weighted)
        left = weighted - self.effects @ sources
        return float(left @ left + sources @ sources)

    def _sources_behind(self, weighted: Floats) -> Floats:
        """Return the likeliest sources of weighted columns of shape (n,) or (n, k), shape (m,) or (m, k)."""
        sources = linalg.cho_solve((self._triangle, True), self.effects.T @ weighted, check_finite=False)
        return np.asarray(sources, dtype=np.float64)

    def products(self, columns_mm: Floats) -> Floats:
        """Return the sums of products of whitened columns of shape (n, k), shape (k, k)."""
        weighted = columns_mm * self.weights[:, None]
        if not self.effects.shape[1]:
            return np.asarray(weighted.T @ weighted, dtype=np.float64)
        known = self.effects.T @ weighted
        taken = linalg.solve_triangular(self._triangle, known, lower=True, check_finite=False)
        return np.asarray(weighted.T @ weighted - taken.T @ taken, dtype=np.float64)


def through_sources(matrix: Floats, effects: Floats, sources: Floats) -> Floats:
    """Return JᵀV⁻¹J from sums over weighted rows, V = I + F Fᵀ; columns of J may be residuals too.

    Args:
        matrix: JᵀJ, shape (..., p, p).
        effects: JᵀF, shape (..., p, m).
        sources: FᵀF, shape (..., m, m).
    """
    if not effects.shape[-1]:
        return matrix
    known = np.linalg.solve(sources + np.eye(sources.shape[-1]), np.swapaxes(effects, -1, -2))
    taken = effects @ known
    return np.asarray(matrix - 0.5 * (taken + np.swapaxes(taken, -1, -2)), dtype=np.float64)
