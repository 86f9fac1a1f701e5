"""Where the uncertainty of a robust estimate comes from: the sandwich of Huber's M-estimators, taken apart."""

import math

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import RowErrors, White
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.estimation import Estimate
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Floats


def sandwich(
    model: Model, found: Estimate, scale: float, influence: Floats, slope: Floats, scatter: str
) -> Contributions:
    """Return A⁻¹ B A⁻¹ with A from the influence's slope and B from its square, shifts by shared errors beside it.

    The scatter that the rows show stands for all white contributors; each stated shared error shifts the estimate by
    what the loss lets it.

    Args:
        model: rows and parameters.
        found: the robust estimate.
        scale: robust standard deviation of a weighted row.
        influence: of each row, in units of the scale, shape (n,).
        slope: derivative of the influence by the standardised residual, shape (n,).
        scatter: name of what stands for the stated white contributors.
    """
    basis, weights = model.parameters.basis, model.weights
    jacobian = (model.jacobian(found.values) * weights[:, None]) @ basis
    size = np.linalg.norm(jacobian, axis=0)
    jacobian = jacobian / size
    bread = linalg.inv(jacobian.T @ (jacobian * slope[:, None]))
    moved = (basis / size) @ bread @ jacobian.T
    widened = math.sqrt(influence.size / (influence.size - basis.shape[1]))
    columns = [moved * (widened * scale * influence)]
    shared = model.shared(found.values)
    columns += [(moved * (slope * weights)) @ one.effects_mm for one in shared]
    white = White(scatter, scale / weights, dof=found.fit.dof)
    # A product with its own transpose is symmetric to the last digit.
    squares = np.stack([one @ one.T for one in columns])
    return Contributions(RowErrors((white,), shared, factor=1.0, factor_dof=math.inf), squares)
