"""A fit seen as a projection: what it leaves of any function of the rows, and what that function would explain.

Everything is in units of the stated white uncertainties (of 1 mm when none are stated) and linear about the estimate.
A function that the model lacks is judged by what is left of it beside the model's own columns (Frisch, Waugh,
Lovell): its coefficient is the one that a fit with it would find, without that fit.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import stacked
from catseye.calibration.core.model import Model
from catseye.calibration.core.significance import Expected, FTest, Judged, f_test
from catseye.calibration.core.types import Floats

_ABSORBED = 1e-5
"""A function of which the model leaves less than this share is absorbed by the model."""


@dataclass(frozen=True)
class Projection:
    """A fit on the space that its model cannot reach.

    Attributes:
        weights: reciprocal white standard uncertainties, 1/mm, shape (n,).
        orthonormal: orthonormal basis of the weighted Jacobian's columns, shape (n, free).
        residuals: weighted residuals, predicted minus measured, shape (n,).
        effects: weighted effects of shared errors that the fit leaves over, shape (n, m).
    """

    weights: Floats
    orthonormal: Floats
    residuals: Floats
    effects: Floats

    @property
    def dof(self) -> int:
        """Degrees of freedom."""
        return int(self.residuals.size) - int(self.orthonormal.shape[1])

    @property
    def square(self) -> float:
        """Sum of squares of the residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def expected(self) -> Expected:
        """Expectation of the sum of squares."""
        return Expected.of(self.dof, self.effects)

    @property
    def unit_um(self) -> float:
        """What one unit of a weighted residual is on the average, µm."""
        return 1e3 / float(np.sqrt(np.mean(self.weights**2)))

    def leftover(self, columns: Floats) -> Floats:
        """Return what the model leaves of weighted columns, shape (n, k)."""
        rest = columns - self.orthonormal @ (self.orthonormal.T @ columns)
        # Once more: the first pass leaves rounding of the size of what it took off.
        return np.asarray(rest - self.orthonormal @ (self.orthonormal.T @ rest), dtype=np.float64)

    def extended(self, columns: Floats) -> Self:
        """Return the projection of the model with further functions, which take up what they can.

        Args:
            columns: derivatives of the residuals by their coefficients, mm per unit, shape (n, k).
        """
        weighted = columns * self.weights[:, None]
        scale = np.linalg.norm(weighted, axis=0)
        left, values, _ = linalg.svd(
            self.leftover(weighted / np.where(scale > 0.0, scale, 1.0)), full_matrices=False
        )
        new = left[:, values > _ABSORBED]
        return replace(
            self,
            orthonormal=np.hstack([self.orthonormal, new]),
            residuals=self.residuals - new @ (new.T @ self.residuals),
            effects=self.effects - new @ (new.T @ self.effects),
        )


def project(model: Model, values: Floats, residuals_mm: Floats) -> Projection:
    """Return a fit as a projection.

    Args:
        values: the estimate, shape (p,).
        residuals_mm: its residuals, shape (n,).
    """
    weights = model.weights
    jacobian = (model.jacobian(values) * weights[:, None]) @ model.parameters.basis
    scaled = jacobian / np.linalg.norm(jacobian, axis=0)
    basis: Floats = linalg.qr(scaled, mode="economic", check_finite=False)[0]
    effects = stacked(model.shared(values), weights.size) * weights[:, None]
    return Projection(weights, basis, residuals_mm * weights, effects - basis @ (basis.T @ effects))


@dataclass(frozen=True)
class Addition(Judged):
    """What functions that the model lacks would explain.

    Attributes:
        coefficients: of the functions, shape (k,), as a fit with them would find.
        covariance: of the coefficients, shape (k, k): stated errors, scaled to the scatter that would be left.
        explained_um: standard deviation that they would take off each row, µm; white scatter taken off.
        ratio: F, mean square that they would explain over the mean square that would be left.
        probability: of a ratio this large when they explain nothing and errors are white.
        probability_stated: of a ratio this large when the stated shared errors act too.
    """

    coefficients: Floats
    covariance: Floats
    explained_um: float
    ratio: float
    probability: float
    probability_stated: float


def addition(projection: Projection, columns: Floats) -> Addition | None:
    """Return what functions would add to a fit.

    Args:
        projection: the fit, on the space that its model cannot reach.
        columns: derivatives of the residuals by the functions' coefficients, mm per unit, shape (n, k).

    Returns:
        None when the model absorbs the functions, so that these rows say nothing of them, or when no degree of
        freedom would be left.
    """
    weighted = columns * projection.weights[:, None]
    scale = np.linalg.norm(weighted, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    left, values, right = linalg.svd(projection.leftover(weighted / scale), full_matrices=False)
    known = values > _ABSORBED
    rank = int(known.sum())
    if rank == 0 or projection.dof - rank < 1:
        return None
    basis = left[:, known]
    back = (right[known].T / values[known]) / scale[:, None]
    along, effects = basis.T @ projection.residuals, basis.T @ projection.effects
    test = _tested(projection, basis, along, effects)
    inner = np.eye(rank) + effects @ effects.T
    return Addition(
        coefficients=-back @ along,
        covariance=test.scale * back @ inner @ back.T,
        explained_um=test.explained_um,
        ratio=test.ratio,
        probability=test.probability,
        probability_stated=test.probability_stated,
    )


def _tested(projection: Projection, basis: Floats, along: Floats, effects: Floats) -> FTest:
    rank = basis.shape[1]
    rest = max(projection.square - float(along @ along), 0.0)
    rest_expected = Expected.of(projection.dof - rank, projection.effects - basis @ effects)
    test = f_test(
        float(along @ along), Expected.of(rank, effects), rank, rest, rest_expected, projection.dof - rank
    )
    size_um = projection.unit_um * test.explained_um / float(np.sqrt(projection.residuals.size))
    return FTest(test.ratio, test.probability, test.probability_stated, test.scale, size_um)
