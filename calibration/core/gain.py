"""What an estimate makes of errors of its rows: the linear map that the estimator stands for."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.model import Model, whitening_at
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening


@dataclass(frozen=True)
class Gain:
    """The estimator, linear about an estimate; V is the covariance of the rows that it takes as given.

    Attributes:
        covariance: of the parameters within the gauge, (JᵀV⁻¹J)⁻¹, shape (p, p).
        matrix: what the estimate moves by for a unit error of each row, (JᵀV⁻¹J)⁻¹JᵀV⁻¹, shape (p, n).
        whitening: of the rows, as the estimator takes it.
    """

    covariance: Floats
    matrix: Floats
    whitening: Whitening

    @classmethod
    def at(cls, model: Model, values: Floats) -> "Gain":
        """Return the gain of rows that determine the estimate of shape (p,)."""
        whitening, basis = whitening_at(model, values), model.parameters.basis
        whitened = whitening.rows(model.jacobian(values))
        covariance = factorise(whitened @ basis).covariance_on(basis)
        matrix = covariance @ (whitening.again(whitened).T * whitening.weights)
        return cls(covariance, np.asarray(matrix, dtype=np.float64), whitening)

    def forces(self, residuals_mm: Floats) -> Floats:
        """Return V⁻¹ times residuals of draws, one column each, shape (n, b)."""
        return self.whitening.forces(residuals_mm)
