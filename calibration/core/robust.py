"""Estimates that single wrong rows hardly move: Huber and soft-L1 loss by reweighted Gauss-Newton steps.

Both losses are convex, so the minimum is one and the start does not matter; what a row can pull is bounded. They
protect against wrong rows, not against a wrong command of high leverage.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import RowErrors, White
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.estimation import Estimate
from catseye.calibration.core.fit_statistics import FitStatistics, RobustLoss
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.model import Model
from catseye.calibration.core.residuals import NORMAL_MAD
from catseye.calibration.core.types import Floats

Loss = Literal["huber", "soft-l1"]

TUNING: dict[Loss, float] = {"huber": 1.345, "soft-l1": 1.2871}
"""Residual in standard deviations where a loss turns from square to linear: 95 % efficiency for normal errors."""

_SCALE_ROUNDS = 10
"""After so many rounds the scale is kept, from where the weights alone are sure to settle."""

_ROUNDS = 200
_SETTLED_MM = 1e-7
_EXACT_MM = 1e-9


@dataclass(frozen=True)
class RobustEstimate:
    """A robust estimate.

    Attributes:
        estimate: with its sandwich covariance.
        scale: robust standard deviation of a row in units of its stated white uncertainty (mm when none).
        weights: what each row counts, 0…1, shape (n,).
        contributions: its covariance, taken apart.
    """

    estimate: Estimate
    scale: float
    weights: Floats
    contributions: Contributions


def robust_estimate(
    model: Model, first: Estimate, loss: Loss, scatter: str = "scatter of the rows"
) -> RobustEstimate:
    """Estimate again with a robust loss.

    The scale is 1.4826 times the median modulus of the residuals, widened by √(n / dof). The covariance is the
    sandwich of Huber's M-estimators: it follows from the scatter that the rows show, not from the stated white
    uncertainties; the stated shared errors are added to it.

    Args:
        first: estimate of least squares, from where the iteration starts.
        scatter: name of what stands for the stated white contributors.

    Raises:
        ConvergenceError: the weights do not settle.
    """
    weights, parameters = model.weights, model.parameters
    values, residuals = first.values, first.residuals_mm
    scale = _scale(residuals, weights, first.fit.dof)
    for round_number in range(1, _ROUNDS + 1):
        share = loss_weight(residuals * weights / scale, loss)
        solution = minimise(
            model.residuals,
            model.jacobian,
            values,
            parameters.basis,
            weights * np.sqrt(share),
            parameters.unsettled,
        )
        change = float(np.sqrt(np.mean((solution.residuals - residuals) ** 2)))
        values, residuals = solution.parameters, solution.residuals
        if change < _SETTLED_MM and round_number > 1:
            found = replace(first, values=values, residuals_mm=residuals)
            return _judged(model, found, loss, (scale, round_number), scatter)
        if round_number < _SCALE_ROUNDS:
            scale = _scale(residuals, weights, first.fit.dof)
    raise ConvergenceError(
        f"the weights of the {loss} loss do not settle: look at the residuals of least squares first "
        "(catseye diagnose)"
    )


def loss_weight(standardised: Floats, loss: Loss) -> Floats:
    """Return what a residual counts: its influence over itself, shape (n,)."""
    relative = np.abs(standardised) / TUNING[loss]
    if loss == "huber":
        return 1.0 / np.maximum(relative, 1.0)
    return np.asarray(1.0 / np.sqrt(1.0 + relative**2), dtype=np.float64)


def _influence_slope(standardised: Floats, loss: Loss) -> Floats:
    """Return the derivative of the influence, shape (n,)."""
    relative = np.abs(standardised) / TUNING[loss]
    if loss == "huber":
        return np.asarray(relative <= 1.0, dtype=np.float64)
    return np.asarray((1.0 + relative**2) ** -1.5, dtype=np.float64)


def _scale(residuals_mm: Floats, weights: Floats, dof: int) -> float:
    median = float(np.median(np.abs(residuals_mm * weights)))
    widened = median / NORMAL_MAD * float(np.sqrt(residuals_mm.size / dof))
    return max(widened, _EXACT_MM * float(np.mean(weights)))


def _judged(
    model: Model, found: Estimate, loss: Loss, settled: tuple[float, int], scatter: str
) -> RobustEstimate:
    """Attach covariance and statistics; `settled` are the scale and the rounds that it took."""
    (scale, rounds), weights = settled, model.weights
    standardised = found.residuals_mm * weights / scale
    share = loss_weight(standardised, loss)
    parts = _sandwich(
        model, found, scale, standardised * share, _influence_slope(standardised, loss), scatter
    )
    sigma_um = 1e3 * scale / float(np.sqrt(np.mean(weights**2)))
    counted = RobustLoss(loss, sigma_um, _half(loss), int(np.sum(share < 0.5)))
    fit = replace(
        _statistics(found.fit, found.residuals_mm, scale, rounds), sigma0_um=sigma_um, robust=counted
    )
    return RobustEstimate(replace(found, covariance=parts.covariance, fit=fit), scale, share, parts)


def _half(loss: Loss) -> float:
    """Return the residual, in standard deviations, that counts half."""
    return TUNING[loss] * (2.0 if loss == "huber" else float(np.sqrt(3.0)))


def _statistics(fit: FitStatistics, residuals_mm: Floats, scale: float, rounds: int) -> FitStatistics:
    """Return the statistics that a robust fit has: no χ², which judges squares."""
    stated = fit.row_variance_mm2 is None
    return replace(
        fit,
        rms_um=1e3 * float(np.sqrt(np.mean(residuals_mm**2))),
        chi2_reduced=None,
        chi2_probability=None,
        lack_of_fit=None,
        variance_ratio=scale**2 if stated else 1.0,
        row_variance_mm2=None if stated else scale**2,
        iterations=rounds,
    )


def _sandwich(
    model: Model, found: Estimate, scale: float, influence: Floats, slope: Floats, scatter: str
) -> Contributions:
    """Return A⁻¹ B A⁻¹ with A from the influence's slope and B from its square, shifts by shared errors beside it.

    The scatter that the rows show stands for all white contributors; each stated shared error shifts the estimate by
    what the loss lets it.

    Args:
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
