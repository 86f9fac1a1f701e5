"""Where the uncertainty of a robust estimate comes from: the sandwich of Huber's M-estimators, taken apart."""

import math

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import DistanceErrors, Shared, White
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.fit_statistics import point_weights
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, effects, geometry_of
from catseye.calibration.scara.distance_model import DistanceModel
from catseye.calibration.scara.identification import Identification

SCATTER = "scatter of the distances"
"""Name of what a robust fit puts in the place of the stated white contributors."""


def sandwich(
    model: DistanceModel, found: Identification, scale: float, influence: Floats, slope: Floats
) -> Contributions:
    """Return A⁻¹ B A⁻¹ with A from the influence's slope and B from its square, systematic shifts beside it.

    The scatter that the distances show stands for all white contributors; each stated systematic contributor shifts
    the estimate by what the loss lets it.

    Args:
        model: the distances.
        found: the robust estimate.
        scale: robust standard deviation of a weighted distance.
        influence: of each distance, in units of the scale, shape (n,).
        slope: derivative of the influence by the standardised residual, shape (n,).
    """
    basis, weights = found.layout.gauge_basis(), point_weights(found.points)
    jacobian = (model.jacobian(found.parameters) * weights[:, None]) @ basis
    size = np.linalg.norm(jacobian, axis=0)
    jacobian = jacobian / size
    bread = linalg.inv(jacobian.T @ (jacobian * slope[:, None]))
    moved = (basis / size) @ bread @ jacobian.T
    widened = math.sqrt(influence.size / (influence.size - basis.shape[1]))
    columns = [moved * (widened * scale * influence)]
    budget, geometry = found.budget or Budget(()), geometry_of(model, found.parameters)
    shared = tuple(
        Shared(one.name, effects(one, geometry), one.distribution, one.dof) for one in budget.systematic
    )
    columns += [(moved * (slope * weights)) @ one.effects_mm for one in shared]
    scatter = White(SCATTER, scale / weights, dof=found.fit.dof)
    # A product with its own transpose is symmetric to the last digit.
    squares = np.stack([one @ one.T for one in columns])
    return Contributions(DistanceErrors((scatter,), shared, factor=1.0, factor_dof=math.inf), squares)
