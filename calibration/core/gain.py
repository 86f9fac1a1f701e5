"""What an estimate makes of errors of its rows: the linear map that the estimator stands for."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Gain:
    """The estimator, linear about an estimate; V is the covariance of the rows that it takes as given.

    Attributes:
        covariance: of the parameters within the gauge, (JᵀV⁻¹J)⁻¹, shape (p, p).
        matrix: what the estimate moves by for a unit error of each row, (JᵀV⁻¹J)⁻¹JᵀV⁻¹, shape (p, n).
        squares: of the weights, 1/mm², shape (n,).
    """

    covariance: Floats
    matrix: Floats
    squares: Floats

    @classmethod
    def at(cls, model: Model, values: Floats) -> "Gain":
        """Return the gain of rows that determine the estimate of shape (p,)."""
        weights, basis = model.weights, model.parameters.basis
        jacobian = model.jacobian(values) * weights[:, None]
        covariance = factorise(jacobian @ basis).covariance_on(basis)
        return cls(covariance, np.asarray(covariance @ (jacobian * weights[:, None]).T), weights**2)

    def forces(self, residuals_mm: Floats) -> Floats:
        """Return V⁻¹ times residuals of draws, one column each, shape (n, b)."""
        return np.asarray(residuals_mm * self.squares[:, None], dtype=np.float64)
