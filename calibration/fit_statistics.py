"""How well a model fits: residual statistics, χ² test, lack of fit against repeated poses."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, stats

from calibration.points import Points
from calibration.types import Floats, Ints

SIGNIFICANCE = 0.01
"""A test rejects when its probability is below this."""

_EXACT_MM = 1e-9
"""Scatter below this is rounding, not measurement."""


@dataclass(frozen=True)
class LackOfFit:
    """F-test of the model against the scatter of poses that were visited more than once.

    The alternative lets each (reflector, θ1, θ2) have a distance of its own and keeps the model's effect of
    the direction of approach. What it explains beyond the model is systematic: the model lacks it.

    Attributes:
        dof_model: degrees of freedom of what the model lacks.
        dof_pure: degrees of freedom of the pure scatter.
        systematic_um: standard deviation of the systematic part of a distance, µm.
        pure_um: standard deviation of the pure scatter, µm.
        ratio: F, mean square of the lack over the mean square of the scatter.
        probability: of a ratio this large when the model is complete.
        inflation: what the variance of a white error has to be multiplied with to cover the systematic part.
    """

    dof_model: int
    dof_pure: int
    systematic_um: float
    pure_um: float
    ratio: float
    probability: float
    inflation: float

    @property
    def significant(self) -> bool:
        """The model lacks something that the repeats show."""
        return self.probability < SIGNIFICANCE


@dataclass(frozen=True)
class FitStatistics:
    """Quality of a fit.

    Attributes:
        n_points: distances used.
        n_parameters: free parameters, the gauge's constraint taken off.
        dof: degrees of freedom.
        rms_um: rms of the residuals, µm.
        sigma0_um: standard deviation of a distance estimated from the fit, µm.
        chi2_reduced: χ² / dof for the stated uncertainties; None when none were stated.
        chi2_probability: of a χ² this large; None when no uncertainties were stated.
        lack_of_fit: test against repeats; None when too few poses are repeated.
        variance_factor: what the covariance of the stated uncertainties was multiplied with.
        iterations: steps of the solver.
    """

    n_points: int
    n_parameters: int
    dof: int
    rms_um: float
    sigma0_um: float
    chi2_reduced: float | None
    chi2_probability: float | None
    lack_of_fit: LackOfFit | None
    variance_factor: float
    iterations: int


def fit_statistics(
    points: Points, residuals_mm: Floats, jacobian: Floats, free: int, iterations: int
) -> FitStatistics:
    """Judge a fit.

    Args:
        points: what was measured, n rows.
        residuals_mm: predicted minus measured, shape (n,).
        jacobian: derivatives of the residuals, shape (n, p).
        free: number of free parameters.
        iterations: steps of the solver.
    """
    dof = len(points) - free
    weights = np.ones(len(points)) if points.sigma_mm is None else 1.0 / points.sigma_mm
    weighted = residuals_mm * weights
    variance = float(weighted @ weighted) / dof
    stated = points.sigma_mm is not None
    probability = float(stats.chi2.sf(variance * dof, dof)) if stated else None
    lack = lack_of_fit(points, residuals_mm, jacobian, free)
    return FitStatistics(
        n_points=len(points),
        n_parameters=free,
        dof=dof,
        rms_um=1e3 * float(np.sqrt(np.mean(residuals_mm**2))),
        sigma0_um=1e3 * float(np.sqrt(variance / np.mean(weights**2))),
        chi2_reduced=variance if stated else None,
        chi2_probability=probability,
        lack_of_fit=lack,
        variance_factor=_variance_factor(variance, probability, lack),
        iterations=iterations,
    )


def _variance_factor(variance: float, probability: float | None, lack: LackOfFit | None) -> float:
    """Return the factor that keeps the stated uncertainties honest.

    Stated uncertainties stand unless the χ² test rejects them; without any, the fit's own scatter is taken. A
    significant lack of fit is common to the repeats of a pose, so it does not average out over them.
    """
    factor = variance if probability is None or probability < SIGNIFICANCE else 1.0
    if lack is not None and lack.significant:
        factor = max(factor, lack.inflation)
    return factor


def lack_of_fit(points: Points, residuals_mm: Floats, jacobian: Floats, free: int) -> LackOfFit | None:
    """Test a fit against repeated poses.

    Returns:
        None when fewer than 10 degrees of freedom remain for the scatter, or when the fit is exact.
    """
    group = _pose_groups(points)
    weights = np.ones(len(points)) if points.sigma_mm is None else 1.0 / points.sigma_mm
    weighted = residuals_mm * weights
    pure, rank = _within_groups(weighted, jacobian * weights[:, None], weights, group)
    dof_pure = len(points) - rank
    dof_model = rank - free
    if dof_pure < 10 or dof_model < 1:
        return None
    pure_square = float(pure @ pure) / dof_pure
    lack_square = max(float(weighted @ weighted - pure @ pure), 0.0) / dof_model
    if pure_square <= (_EXACT_MM * float(np.mean(weights))) ** 2:
        return None
    ratio = lack_square / pure_square
    per_pose = len(points) / (int(group.max()) + 1)
    unit_um = 1e3 / float(np.sqrt(np.mean(weights**2)))
    return LackOfFit(
        dof_model=dof_model,
        dof_pure=dof_pure,
        systematic_um=unit_um * float(np.sqrt(max(lack_square - pure_square, 0.0) / per_pose)),
        pure_um=unit_um * float(np.sqrt(pure_square)),
        ratio=ratio,
        probability=float(stats.f.sf(ratio, dof_model, dof_pure)),
        inflation=lack_square,
    )


def _pose_groups(points: Points) -> Ints:
    """Return the number of each point's (reflector, dead path, θ1, θ2), shape (n,)."""
    angles = np.round(np.stack([points.commands.theta1_rad, points.commands.theta2_rad], axis=1), 9)
    keys = np.column_stack([points.reflector, points.dead_path, angles])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    return np.ravel(group).astype(np.int64)


def _within_groups(residuals: Floats, jacobian: Floats, weights: Floats, group: Ints) -> tuple[Floats, int]:
    """Return the residuals that neither the groups' levels nor the model explain, and that model's rank."""
    stacked = np.column_stack([jacobian, residuals])
    norm = np.bincount(group, weights**2)
    levels = np.stack([np.bincount(group, weights * column) for column in stacked.T], axis=1) / norm[:, None]
    within = stacked - weights[:, None] * levels[group]
    scale = np.linalg.norm(jacobian, axis=0)
    left, values, _ = linalg.svd(within[:, :-1] / np.where(scale > 0.0, scale, 1.0), full_matrices=False)
    left = left[:, values > 1e-9]
    pure = within[:, -1] - left @ (left.T @ within[:, -1])
    return pure, int(group.max()) + 1 + left.shape[1]
