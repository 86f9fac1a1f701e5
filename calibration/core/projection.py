"""A fit seen as a projection: what it leaves of any function of the rows, and what that function would explain.

Everything is whitened (in units of 1 mm when no uncertainty is stated) and linear about the estimate. A function
that the model lacks is judged by what is left of it beside the model's own columns (Frisch, Waugh, Lovell): its
coefficient is the one that a fit with it would find, without that fit.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from scipy import linalg

from catseye.calibration.core.least_squares import column_space
from catseye.calibration.core.model import Model, whitening_at
from catseye.calibration.core.significance import FTest, Judged, f_test
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening

_ABSORBED = 1e-5
"""A function of which the model leaves less than this share is absorbed by the model."""


@dataclass(frozen=True)
class Projection:
    """A fit on the space that its model cannot reach.

    What a single row, or a group of rows, says beside the others is read off Q = V⁻¹ − V⁻¹J(JᵀV⁻¹J)⁻¹JᵀV⁻¹ in units
    of the white uncertainties: Q = I − `reach` reachᵀ, and Q times the residuals is `pulls`.

    Attributes:
        whitening: of the rows.
        orthonormal: orthonormal basis of the whitened Jacobian's columns, shape (n, free).
        residuals: whitened residuals, predicted minus measured, shape (n,).
    """

    whitening: Whitening
    orthonormal: Floats
    residuals: Floats

    @property
    def weights(self) -> Floats:
        """Reciprocal white standard uncertainties, 1/mm, shape (n,)."""
        return self.whitening.weights

    @property
    def dof(self) -> int:
        """Degrees of freedom."""
        return int(self.residuals.size) - int(self.orthonormal.shape[1])

    @property
    def square(self) -> float:
        """Sum of squares of the residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def unit_um(self) -> float:
        """What one unit of a weighted residual is on the average, µm."""
        return 1e3 / float(np.sqrt(np.mean(self.weights**2)))

    @cached_property
    def reach(self) -> Floats:
        """What shared sources and the model take of a row, shape (n, m + free)."""
        return np.hstack([self.whitening.reach, self.whitening.again(self.orthonormal)])

    @cached_property
    def pulls(self) -> Floats:
        """Q times the residuals, in units of the white uncertainties, shape (n,)."""
        return self.whitening.again(self.residuals)

    @property
    def rms_um(self) -> float:
        """Rms of the residuals, predicted minus measured, µm."""
        effects = self.whitening.effects
        residuals_mm = (self.pulls + effects @ (effects.T @ self.pulls)) / self.weights
        return 1e3 * float(np.sqrt(np.mean(residuals_mm**2)))

    @cached_property
    def own(self) -> Floats:
        """Diagonal of Q, shape (n,): a pull over it is what the other rows predict of a row minus the row."""
        return 1.0 - np.asarray(np.einsum("ij,ij->i", self.reach, self.reach))

    def leftover(self, columns: Floats) -> Floats:
        """Return what the model leaves of whitened columns, shape (n, k)."""
        rest = columns - self.orthonormal @ (self.orthonormal.T @ columns)
        # Once more: the first pass leaves rounding of the size of what it took off.
        return np.asarray(rest - self.orthonormal @ (self.orthonormal.T @ rest), dtype=np.float64)

    @property
    def settled(self) -> Self:
        """The fit where the weights at hand settle: residuals may come from other weights, or from a larger model."""
        return replace(self, residuals=self.leftover(self.residuals))

    def extended(self, columns: Floats) -> Self:
        """Return the projection of the model with further functions, which take up what they can.

        Args:
            columns: derivatives of the residuals by their coefficients, mm per unit, shape (n, k).
        """
        whitened = self.whitening.rows(columns)
        scale = np.linalg.norm(whitened, axis=0)
        left, values, _ = linalg.svd(
            self.leftover(whitened / np.where(scale > 0.0, scale, 1.0)), full_matrices=False
        )
        new = left[:, values > _ABSORBED]
        return replace(
            self,
            orthonormal=np.hstack([self.orthonormal, new]),
            residuals=self.residuals - new @ (new.T @ self.residuals),
        )


def project(model: Model, values: Floats, residuals_mm: Floats) -> Projection:
    """Return a fit as a projection.

    Args:
        values: the estimate, shape (p,).
        residuals_mm: its residuals, shape (n,).
    """
    whitening = whitening_at(model, values)
    whitened = whitening.rows(model.jacobian(values) @ model.parameters.basis)
    return off_columns(whitening, whitened, residuals_mm)


def off_columns(whitening: Whitening, whitened: Floats, residuals_mm: Floats) -> Projection:
    """Return a fit as a projection off the columns of its model.

    Args:
        whitened: derivatives of the residuals, shape (n, free).
        residuals_mm: its residuals, shape (n,).
    """
    return Projection(whitening, column_space(whitened.copy()), whitening.rows(residuals_mm))


@dataclass(frozen=True)
class Addition(Judged):
    """What functions that the model lacks would explain.

    Attributes:
        coefficients: of the functions, shape (k,), as a fit with them would find.
        covariance: of the coefficients, shape (k, k): stated errors, scaled to the scatter that would be left.
        rank: how many of the functions, or of their combinations, the model does not absorb.
        explained_um: standard deviation that they would take off each row, µm; white scatter taken off.
        ratio: F, mean square that they would explain over the mean square that would be left.
        probability: of a ratio this large when they explain nothing.
    """

    coefficients: Floats
    covariance: Floats
    rank: int
    explained_um: float
    ratio: float
    probability: float


def addition(projection: Projection, columns: Floats) -> Addition | None:
    """Return what functions would add to a fit.

    Args:
        projection: the fit, on the space that its model cannot reach.
        columns: derivatives of the residuals by the functions' coefficients, mm per unit, shape (n, k).

    Returns:
        None when the model absorbs the functions, so that these rows say nothing of them, or when no degree of
        freedom would be left.
    """
    return additions(projection, columns, columns.shape[1])[0]


def additions(projection: Projection, columns: Floats, together: int) -> list[Addition | None]:
    """Return what each of several groups of functions would add to a fit alone: many cost little more than one.

    Args:
        projection: the fit, on the space that its model cannot reach.
        columns: derivatives as those of `addition`, shape (n, groups · together).
        together: functions of a group; those of one stand side by side.
    """
    weighted = columns * projection.weights[:, None]
    taken, pulls = projection.reach.T @ weighted, weighted.T @ projection.pulls
    groups = [slice(first, first + together) for first in range(0, columns.shape[1], together)]
    return [_added(projection, weighted[:, one], taken[:, one], pulls[one]) for one in groups]


def _added(projection: Projection, weighted: Floats, taken: Floats, pulls: Floats) -> Addition | None:
    """Return what functions add.

    Args:
        weighted: the functions C in units of the white uncertainties, shape (n, k).
        taken: what shared sources and the model take of them, shape (m + free, k).
        pulls: CᵀQr, shape (k,).
    """
    sources = projection.whitening.effects.shape[1]
    whole = weighted.T @ weighted
    beside = whole - taken[:sources].T @ taken[:sources]
    size = np.sqrt(np.maximum(np.diag(beside), 0.0))
    scale = np.where(size > 0.0, size, 1.0)
    left = (beside - taken[sources:].T @ taken[sources:]) / np.outer(scale, scale)
    squares, directions = linalg.eigh(left, check_finite=False)
    known = squares > _ABSORBED**2
    rank = int(known.sum())
    if rank == 0 or projection.dof - rank < 1:
        return None
    back = (directions[:, known] / np.sqrt(squares[known])) / scale[:, None]
    along = back.T @ pulls
    gain = float(along @ along)
    test = f_test(gain, rank, max(projection.square - gain, 0.0), projection.dof - rank)
    return Addition(
        coefficients=-back @ along,
        covariance=test.scale * back @ back.T,
        rank=rank,
        explained_um=explained_um(projection, test),
        ratio=test.ratio,
        probability=test.probability,
    )


def explained_um(projection: Projection, test: FTest) -> float:
    """Return the standard deviation of a row that a larger model explains, µm."""
    return projection.unit_um * test.explained / float(np.sqrt(projection.residuals.size))
