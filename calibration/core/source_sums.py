"""What rows say of the sources of errors that they share, from sums: rows in memory and scans alike."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import Shared, stacked
from catseye.calibration.core.least_squares import column_space
from catseye.calibration.core.model import Model
from catseye.calibration.core.significance import FTest, f_test
from catseye.calibration.core.types import Bools, Floats, Ints

_ABSORBED = 1e-8
"""A direction of whose square less than this share is left is absorbed: sums of squares carry no more digits."""


@dataclass(frozen=True)
class SourceSums:
    """Sums over rows, the parameters eliminated.

    F are the weighted effects of m sources of unit variance, r the weighted residuals (predicted minus measured), P
    is the projection off the model's columns.

    Attributes:
        whole: diagonal of FᵀF, shape (m,).
        matrix: FᵀPF, shape (m, m).
        vector: FᵀPr, shape (m,).
        square: rᵀPr.
        dof: rows less free parameters.
        owner: number of the shared error that each source belongs to, shape (m,).
    """

    whole: Floats
    matrix: Floats
    vector: Floats
    square: float
    dof: int
    owner: Ints

    @classmethod
    def of(cls, model: Model, values: Floats) -> "SourceSums":
        """Sum up a model's rows at an estimate of shape (p,)."""
        shared, weights = model.shared(values), model.weights
        effects = stacked(shared, weights.size) * weights[:, None]
        columns = column_space((model.jacobian(values) * weights[:, None]) @ model.parameters.basis)
        residuals = model.residuals(values) * weights
        left, rest = (rows - columns @ (columns.T @ rows) for rows in (effects, residuals))
        whole = np.einsum("ij,ij->j", effects, effects)
        dof = weights.size - columns.shape[1]
        return cls(whole, left.T @ left, left.T @ rest, float(rest @ rest), dof, owners(shared))

    def known(self, error: int) -> tuple[Floats, Floats]:
        """Return the conditional mean of the sources of one error, shape (k,), and their covariance, shape (k, k).

        Both are those of stated variances, for rows that scatter as stated.
        """
        own = self.owner == error
        spread = linalg.inv(np.eye(own.size) + self.matrix)
        return -spread[own] @ self.vector, np.asarray(spread[np.ix_(own, own)])

    def test(self, error: int) -> FTest | None:
        """Test the functions that the sources of one error stand for, beside the model and all other errors.

        Returns:
            None where the model absorbs them, or leaves no degree of freedom.
        """
        own = self.owner == error
        left, pulls, explained = beside_others(self.matrix, self.vector, own)
        scale = np.sqrt(np.where(self.whole[own] > 0.0, self.whole[own], 1.0))
        squares, directions = linalg.eigh(left / np.outer(scale, scale))
        shown = squares > _ABSORBED
        rank = int(shown.sum())
        if rank == 0 or self.dof - rank < 1:
            return None
        along = directions[:, shown].T @ (pulls / scale) / np.sqrt(squares[shown])
        gain = float(along @ along)
        return f_test(gain, rank, max(self.square - explained - gain, 0.0), self.dof - rank)


def beside_others(matrix: Floats, vector: Floats, own: Bools) -> tuple[Floats, Floats, float]:
    """Eliminate all sources but some of unit variance.

    Args:
        matrix: FᵀPF, shape (m, m).
        vector: FᵀPr, shape (m,).
        own: those that stay, k of them, shape (m,).

    Returns:
        FᵀQF, shape (k, k), and FᵀQr, shape (k,), of those that stay, and rᵀPr − rᵀQr; Q is P with all others.
    """
    inner = np.eye(int(np.sum(~own))) + matrix[np.ix_(~own, ~own)]
    across, others = matrix[np.ix_(~own, own)], vector[~own]
    taken = linalg.solve(inner, np.column_stack([across, others]), assume_a="pos")
    left = matrix[np.ix_(own, own)] - across.T @ taken[:, :-1]
    return left, vector[own] - across.T @ taken[:, -1], float(others @ taken[:, -1])


def owners(shared: Sequence[Shared]) -> Ints:
    """Return the number of the shared error that each source belongs to, shape (m,)."""
    sizes = np.array([one.effects_mm.shape[1] for one in shared], dtype=np.int64)
    return np.repeat(np.arange(len(shared)), sizes)
