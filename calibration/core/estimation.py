"""From rows to parameters with their covariance."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.fit_statistics import FitStatistics, fit_statistics
from catseye.calibration.core.lack_of_fit import WhitenedFit
from catseye.calibration.core.least_squares import STEP_TOLERANCE, Solution, minimise
from catseye.calibration.core.model import Model, whitening_at
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening

_ROUGH_MM = 0.01
"""A step that changes residuals by less, rms, ends where shared errors are known to a billionth of themselves."""


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
    """Estimate the parameters by generalised least squares: white and shared errors both give the weights (ADR 25).

    What shared errors do to the rows depends on the parameters. It is taken where white errors alone put them, a
    matter of micrometres, and once more at the estimate that follows: a third time would change nothing.

    Args:
        start: starting values, shape (p,); they fulfil the gauge.

    Raises:
        UnidentifiableError: null directions beyond the gauge; the parameters are named.
        ConvergenceError: the iteration does not settle.
    """
    parameters = model.parameters
    solution = _solved(model, start, Whitening.of(model.weights), None, _ROUGH_MM)
    whitening = whitening_at(model, solution.parameters)
    if whitening.effects.shape[1]:
        solution = _solved(model, solution.parameters, whitening, solution.jacobian, _ROUGH_MM)
        whitening = whitening_at(model, solution.parameters)
    solution = _solved(model, solution.parameters, whitening, solution.jacobian, STEP_TOLERANCE)
    if not solution.factor.regular.all():
        require_identifiable(parameters, solution.whitening.rows(solution.jacobian))
    return _judged(model, solution)


def _solved(
    model: Model, start: Floats, whitening: Whitening, near: Floats | None, tolerance_mm: float
) -> Solution:
    basis, unsettled = model.parameters.basis, model.parameters.unsettled
    return minimise(model.residuals, model.jacobian, start, basis, whitening, unsettled, near, tolerance_mm)


def _judged(model: Model, solution: Solution) -> Estimate:
    """Attach statistics and covariance to a solution."""
    basis = model.parameters.basis
    fit = fit_statistics(
        WhitenedFit(
            whitening=solution.whitening,
            stated=model.stated,
            repeats=model.repeats,
            residuals_mm=solution.residuals,
            jacobian=solution.jacobian,
            free=basis.shape[1],
            iterations=solution.iterations,
        )
    )
    covariance = fit.unit_weight_variance * solution.factor.covariance_on(basis)
    return Estimate(solution.parameters, np.asarray(covariance), solution.residuals, fit)
