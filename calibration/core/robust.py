"""Estimates that single wrong rows hardly move: Huber and soft-L1 loss by reweighted Gauss-Newton steps.

Both losses are convex, so the minimum is one and the start does not matter; what a row can pull is bounded. They
protect against wrong rows, not against a wrong command of high leverage.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy import linalg

from catseye.calibration.core.budget import RowErrors, White, stacked
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.estimation import Estimate
from catseye.calibration.core.fit_statistics import FitStatistics, RobustLoss
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.model import Model, whitening_at
from catseye.calibration.core.residuals import NORMAL_MAD
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening

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

    The loss judges what is a row's own: its residual less what the stated shared errors explain of it. The scale is
    1.4826 times the median modulus of that, widened for what the fit takes up. The covariance is the sandwich of
    Huber's M-estimators: its white part follows from the scatter that the rows show, not from the stated white
    uncertainties; shared errors are taken as stated.

    Args:
        first: estimate of least squares, from where the iteration starts.
        scatter: name of what stands for the stated white contributors.

    Raises:
        ConvergenceError: the weights do not settle.
    """
    parameters, stated = model.parameters, whitening_at(model, first.values)
    values, residuals = first.values, first.residuals_mm
    taken = first.fit.n_parameters + float(np.sum(stated.reach**2))
    own = stated.again(stated.rows(residuals))
    scale = _scale(own, stated.weights, taken)
    for round_number in range(1, _ROUNDS + 1):
        share = loss_weight(own / scale, loss)
        whitening = _reweighted(stated, np.sqrt(share) / scale)
        solution = minimise(
            model.residuals, model.jacobian, values, parameters.basis, whitening, parameters.unsettled
        )
        change = float(np.sqrt(np.mean((solution.residuals - residuals) ** 2)))
        values, residuals = solution.parameters, solution.residuals
        own = whitening.again(whitening.rows(residuals)) * scale / np.sqrt(share)
        if change < _SETTLED_MM and round_number > 1:
            found = replace(first, values=values, residuals_mm=residuals)
            return _judged(model, found, loss, _Settled(own, scale, round_number), scatter)
        if round_number < _SCALE_ROUNDS:
            scale = _scale(own, stated.weights, taken)
    raise ConvergenceError(
        f"the weights of the {loss} loss do not settle: look at the residuals of least squares first "
        "(catseye diagnose)"
    )


@dataclass(frozen=True)
class _Settled:
    """Where the weights settled.

    Attributes:
        own: weighted residuals less what shared errors explain, shape (n,).
        scale: their robust standard deviation.
        rounds: that it took.
    """

    own: Floats
    scale: float
    rounds: int


def _reweighted(whitening: Whitening, factor: Floats) -> Whitening:
    """Return the whitening of rows whose weights are multiplied with factors of shape (n,)."""
    return Whitening(whitening.weights * factor, whitening.effects * factor[:, None])


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


def _scale(own: Floats, weights: Floats, taken: float) -> float:
    """Return the robust standard deviation of weighted residuals of which a fit took so many degrees of freedom."""
    median = float(np.median(np.abs(own)))
    widened = median / NORMAL_MAD * math.sqrt(own.size / max(own.size - taken, 1.0))
    return max(widened, _EXACT_MM * float(np.mean(weights)))


def _judged(model: Model, found: Estimate, loss: Loss, settled: _Settled, scatter: str) -> RobustEstimate:
    """Attach covariance and statistics."""
    scale, weights = settled.scale, model.weights
    standardised = settled.own / scale
    share = loss_weight(standardised, loss)
    parts = _sandwich(
        model, found, scale, standardised * share, _influence_slope(standardised, loss), scatter
    )
    sigma_um = 1e3 * scale / float(np.sqrt(np.mean(weights**2)))
    counted = RobustLoss(loss, sigma_um, _half(loss), int(np.sum(share < 0.5)))
    fit = replace(
        _statistics(found.fit, found.residuals_mm, scale, settled.rounds), sigma0_um=sigma_um, robust=counted
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
    """Return A⁻¹ B A⁻¹ with A from the influence's slope and B from its square, shared errors as further unknowns.

    The scatter that the rows show stands for all white contributors. A shared error is an unknown of unit variance,
    known beforehand to that: A has 1 added for it, and so has B.

    Args:
        scale: robust standard deviation of a weighted row.
        influence: of each row, in units of the scale, shape (n,).
        slope: derivative of the influence by the standardised residual, shape (n,).
        scatter: name of what stands for the stated white contributors.
    """
    basis, weights, shared = model.parameters.basis, model.weights / scale, model.shared(found.values)
    jacobian = (model.jacobian(found.values) * weights[:, None]) @ basis
    size, free = np.linalg.norm(jacobian, axis=0), basis.shape[1]
    unknowns = np.hstack([jacobian / size, stacked(shared, weights.size) * weights[:, None]])
    known = np.diag(np.arange(unknowns.shape[1]) >= free).astype(np.float64)
    bread = linalg.inv(unknowns.T @ (unknowns * slope[:, None]) + known)
    moved = (basis / size) @ bread[:free]
    widened = math.sqrt(influence.size / (influence.size - free))
    ends = free + np.cumsum([0, *(one.effects_mm.shape[1] for one in shared)])
    columns = [(moved @ unknowns.T) * (widened * influence)]
    columns += [moved[:, first:last] for first, last in pairwise(ends.tolist())]
    white = White(scatter, 1.0 / weights, dof=found.fit.dof)
    # A product with its own transpose is symmetric to the last digit.
    squares = np.stack([one @ one.T for one in columns])
    return Contributions(RowErrors((white,), shared, factor=1.0, factor_dof=math.inf), squares)
