"""From rows to parameters with their covariance."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import stacked
from catseye.calibration.core.fit_statistics import FitStatistics, fit_statistics
from catseye.calibration.core.lack_of_fit import WeightedFit
from catseye.calibration.core.least_squares import Solution, minimise
from catseye.calibration.core.model import Model
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Estimate:
    """What the rows say of the parameters.

    Attributes:
        values: of the parameters, shape (p,).
        covariance: of the values in the stated gauge, shape (p, p).
        residuals_mm: predicted minus measured, shape (n,).
        fit: quality of the fit.
    """

    values: Floats
    covariance: Floats
    residuals_mm: Floats
    fit: FitStatistics


def estimate(model: Model, start: Floats) -> Estimate:
    """Estimate the parameters by weighted least squares.

    White errors give the weights; errors that rows share are carried through to the covariance (ADR 3).

    Args:
        start: starting values, shape (p,); they fulfil the gauge.

    Raises:
        UnidentifiableError: null directions beyond the gauge; the parameters are named.
        ConvergenceError: the iteration does not settle.
    """
    parameters, weights = model.parameters, model.weights
    solution = minimise(
        model.residuals, model.jacobian, start, parameters.basis, weights, parameters.unsettled
    )
    if not solution.factor.regular.all():
        require_identifiable(parameters, solution.jacobian * weights[:, None])
    return _judged(model, solution)


def _judged(model: Model, solution: Solution) -> Estimate:
    """Attach statistics and covariance to a solution."""
    weights, basis = model.weights, model.parameters.basis
    white = solution.factor.covariance_on(basis)
    jacobian = solution.jacobian * weights[:, None]
    effects = stacked(model.shared(solution.parameters), weights.size) * weights[:, None]
    # How shared errors shift the estimate, and what of them stays in the residuals.
    shifts = white @ (jacobian.T @ effects)
    fit = fit_statistics(
        WeightedFit(
            weights=weights,
            stated=model.stated,
            repeats=model.repeats,
            residuals=solution.residuals * weights,
            jacobian=jacobian,
            effects=effects - jacobian @ shifts,
            free=basis.shape[1],
            iterations=solution.iterations,
        )
    )
    covariance = np.asarray(fit.unit_weight_variance * (white + shifts @ shifts.T), dtype=np.float64)
    return Estimate(solution.parameters, covariance, solution.residuals, fit)
