"""Normal equations summed up block by block, and the covariance that they give."""

from dataclasses import dataclass, field

import numpy as np
from scipy import linalg

from catseye.calibration.core.blockwise.residual_sums import ResidualSums
from catseye.calibration.core.blockwise.sparse_rows import Slot, SparseRows
from catseye.calibration.core.gauge import Gauge
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.source_sums import SourceSums
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.core.whitening import through_sources

SQUARED_RANK_TOLERANCE = 3e-6
"""Singular values below this share of the largest count as zero here.

The normal matrix holds their squares, 1e-11 of its largest eigenvalue: a hundred times what rounding of its sums
leaves. A Jacobian itself separates directions down to 1e-10; what lies between is refused here although the
rows themselves could solve it, for the squares of such values carry too few digits for an uncertainty."""


_ROUNDING = 1e-13
"""Share of its largest sums that a difference of sums may be off by."""


@dataclass
class NormalSums:
    """Sums over the rows of a pass; W are the squares of the weights.

    Attributes:
        size: number of parameters p.
        residuals: the residuals themselves, summed up.
        white_gradient: JᵀWr, shape (p,).
        white_cost: rᵀWr.
        weight: trace of W, 1/mm².
        effect_gradient: JᵀWE of the effects of m shared sources, shape (p, m).
        effect_matrix: EᵀWE, shape (m, m).
        effect_residuals: EᵀWr, shape (m,).
    """

    size: int
    residuals: ResidualSums
    white_gradient: Floats = field(init=False)
    effect_gradient: Floats = field(init=False)
    effect_matrix: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    effect_residuals: Floats = field(default_factory=lambda: np.zeros(0))
    white_cost: float = 0.0
    weight: float = 0.0
    _products: dict[tuple[int, int], Floats] = field(default_factory=dict)
    _columns: list[slice] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.white_gradient = np.zeros(self.size)
        self.effect_gradient = np.zeros((self.size, 0))

    def add(self, block: SparseRows, weights: Floats, group: Ints) -> None:
        """Take in a block.

        Args:
            block: residuals, mm, and weighted derivatives.
            weights: reciprocal standard uncertainties, 1/mm, shape (n,).
            group: number of each row's group, shape (n,).
        """
        weighted = block.residuals * weights
        self.white_cost += float(weighted @ weighted)
        self.weight += float(weights @ weights)
        self.residuals = self.residuals.plus(block.residuals, group)
        self._columns = [slice(slot.start, slot.start + slot.span) for slot in block.slots]
        for slot, columns in zip(block.slots, self._columns, strict=True):
            self.white_gradient[columns] += np.bincount(slot.column, slot.value * weighted, slot.span)
        for i, first in enumerate(block.slots):
            for j in range(i, len(block.slots)):
                self._add_product((i, j), first, block.slots[j])

    def add_effects(self, block: SparseRows, weights: Floats, effects: Floats) -> None:
        """Take in what shared sources do to a block, weighted, shape (n, m)."""
        gradient, matrix = np.asarray(block.matrix().T @ effects), effects.T @ effects
        residual = effects.T @ (block.residuals * weights)
        if self.effect_matrix.size:
            gradient, matrix = gradient + self.effect_gradient, matrix + self.effect_matrix
            residual += self.effect_residuals
        self.effect_gradient, self.effect_matrix, self.effect_residuals = gradient, matrix, residual

    def _add_product(self, pair: tuple[int, int], first: Slot, second: Slot) -> None:
        """Sum the products of two entries by the pair of columns that they belong to."""
        key = first.column * second.span + second.column
        product = np.bincount(key, first.value * second.value, first.span * second.span)
        if pair in self._products:
            self._products[pair] += product
        else:
            self._products[pair] = product.astype(np.float64)

    @property
    def gradient(self) -> Floats:
        """JᵀV⁻¹r, V the covariance of white and shared errors, shape (p,)."""
        return np.asarray(self.white_gradient - self.effect_gradient @ self._sources, dtype=np.float64)

    @property
    def cost(self) -> float:
        """rᵀV⁻¹r."""
        return float(self.white_cost - self.effect_residuals @ self._sources)

    def taken_up(self, covariance: Floats) -> Floats:
        """Return what sources of unit variance move an estimate by, C JᵀV⁻¹E, shape (p, m).

        Args:
            covariance: (JᵀV⁻¹J)⁻¹ within the gauge, shape (p, p).
        """
        inner = self.effect_matrix + np.eye(self.effect_residuals.size)
        return np.asarray(covariance @ np.linalg.solve(inner, self.effect_gradient.T).T, dtype=np.float64)

    @property
    def _sources(self) -> Floats:
        """What the residuals say of the sources, shape (m,)."""
        inner = self.effect_matrix + np.eye(self.effect_residuals.size)
        return np.asarray(np.linalg.solve(inner, self.effect_residuals), dtype=np.float64)

    def matrix(self) -> Floats:
        """Return JᵀV⁻¹J, shape (p, p)."""
        return through_sources(self.white_matrix(), self.effect_gradient, self.effect_matrix)

    def change_mm(self, step: Floats) -> float:
        """Return the rms change of the residuals that is expected of a step of shape (p,), mm: √(sᵀJᵀV⁻¹Js / Σw).

        What shared errors explain as well does not count: there rounding alone makes steps of their size.
        """
        return float(np.sqrt(max(float(step @ self.matrix() @ step), 0.0) / self.weight))

    def white_matrix(self) -> Floats:
        """Return JᵀWJ, shape (p, p)."""
        upper = np.zeros((self.size, self.size))
        for (i, j), product in self._products.items():
            block = upper[self._columns[i], self._columns[j]]
            # Both halves are added up at the end, so the square of an entry counts half here.
            block += (0.5 if i == j else 1.0) * product.reshape(block.shape)
        return np.asarray(upper + upper.T, dtype=np.float64)


def white_covariance(sums: NormalSums, parameters: Parameters, gauge: Gauge) -> Floats:
    """Return the covariance that normal equations give white errors alone, shape (p, p).

    White errors alone say which directions are determined: shared errors, however large, take none away, but what
    they leave of the matrix is a difference that may be all rounding.

    Raises:
        UnidentifiableError: directions that the normal matrix does not separate from null directions.
    """
    white = sums.white_matrix()
    reduced = gauge.reduced(white)
    scale = 1.0 / np.sqrt(np.where(np.diag(reduced) > 0.0, np.diag(reduced), 1.0))
    scaled = reduced * np.outer(scale, scale)
    try:
        inverse = _inverse(scaled)
    except linalg.LinAlgError:
        require_identifiable(parameters, _square_root(white), SQUARED_RANK_TOLERANCE)
        raise
    # Norms bound the condition from above; eigenvalues, which take ten times as long, are left for what is doubtful.
    if SQUARED_RANK_TOLERANCE**2 * linalg.norm(scaled, 1) * linalg.norm(inverse, 1) > 1.0:
        require_identifiable(parameters, _square_root(white), SQUARED_RANK_TOLERANCE)
    return gauge.expanded(inverse * np.outer(scale, scale))


def source_sums(sums: NormalSums, white: Floats, free: int, owner: Ints) -> SourceSums:
    """Return what the rows say of the shared sources beside the parameters.

    Args:
        white: covariance of white errors alone, shape (p, p).
        free: parameters.
        owner: number of the shared error that each source belongs to, shape (m,).
    """
    moved, step = sums.effect_gradient.T @ white, white @ sums.white_gradient
    whole = np.diag(sums.effect_matrix)
    scale = np.sqrt(np.where(whole > 0.0, whole, 1.0))
    left = (sums.effect_matrix - moved @ sums.effect_gradient) / np.outer(scale, scale)
    # Rounding is nothing that rows say.
    known, directions = linalg.eigh(0.5 * (left + left.T))
    left = (directions * np.where(known > _ROUNDING, known, 0.0)) @ directions.T
    return SourceSums(
        whole,
        left * np.outer(scale, scale),
        sums.effect_residuals - sums.effect_gradient.T @ step,
        sums.white_cost - float(sums.white_gradient @ step),
        sums.residuals.rows - free,
        owner,
    )


def widened(covariance: Floats, sums: NormalSums) -> Floats:
    """Add what shared errors make of a covariance of white errors alone, shape (p, p) (Woodbury)."""
    moved = covariance @ sums.effect_gradient
    if not moved.size:
        return covariance
    # What rows say of the sources beside the parameters. Rounding is nothing that they say.
    known, directions = linalg.eigh(sums.effect_matrix - sums.effect_gradient.T @ moved)
    rounding = _ROUNDING * linalg.norm(sums.effect_matrix, 2)
    half = (moved @ directions) / np.sqrt(1.0 + np.where(known > rounding, known, 0.0))
    return np.asarray(covariance + half @ half.T, dtype=np.float64)


def _inverse(matrix: Floats) -> Floats:
    """Return the inverse of a positive definite matrix.

    Raises:
        LinAlgError: it is singular.
    """
    lower = linalg.cholesky(matrix, lower=True, check_finite=False)
    inverse, _ = linalg.lapack.dpotri(lower, lower=1, overwrite_c=1)
    return np.asarray(np.tril(inverse) + np.tril(inverse, -1).T, dtype=np.float64)


def _square_root(matrix: Floats) -> Floats:
    """Return R with RᵀR = matrix, shape (p, p): it stands for the Jacobian; a column of zeros stays one."""
    norms = np.sqrt(np.diag(matrix))
    scale = np.where(norms > 0.0, norms, 1.0)
    values, vectors = linalg.eigh(matrix / np.outer(scale, scale))
    return np.asarray((np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T) * norms, dtype=np.float64)
