"""What an estimate makes of errors of its rows: the linear map that the estimator stands for."""

import numpy as np

from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Floats


def gain(model: Model, values: Floats) -> Floats:
    """Return what the estimate moves by for a unit error of each row, shape (p, n).

    Minus the gain times the residuals is the estimator's step, and it keeps the gauge.

    Args:
        values: the estimate, shape (p,); the rows determine it.
    """
    weights, basis = model.weights, model.parameters.basis
    jacobian = model.jacobian(values) * weights[:, None]
    white = factorise(jacobian @ basis).covariance_on(basis)
    return np.asarray(white @ (jacobian * weights[:, None]).T)
