"""How well a model fits: statistics of its residuals, χ² test, and what its covariance is widened by."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.lack_of_fit import LackOfFit, WhitenedFit, lack_of_fit
from catseye.calibration.core.significance import SIGNIFICANCE, chi2_probability


@dataclass(frozen=True)
class RobustLoss:
    """What a robust loss made of the rows.

    Attributes:
        loss: "huber" or "soft-l1".
        sigma_um: robust standard deviation of a row, µm.
        half: residual that counts half, in robust standard deviations.
        counted_little: rows that count less than half.
    """

    loss: str
    sigma_um: float
    half: float
    counted_little: int


@dataclass(frozen=True)
class FitStatistics:
    """Quality of a fit.

    Attributes:
        n_points: rows used.
        n_parameters: free parameters, the gauge's constraint taken off.
        dof: degrees of freedom.
        rms_um: rms of the residuals, µm.
        sigma0_um: white standard deviation of a row estimated from the fit, µm.
        chi2_reduced: χ² / dof for the stated uncertainties, shared errors included; None when none were stated.
        chi2_probability: of a χ² this large; None when no uncertainties were stated.
        lack_of_fit: test against repeats; None when too few rows are repeated.
        variance_ratio: what stated variances were multiplied with; 1 where none were stated.
        row_variance_mm2: variance of a row from the scatter of the fit, mm²; None where one was stated.
        iterations: steps of the solver.
        robust: of a robust fit; None for least squares.
    """

    n_points: int
    n_parameters: int
    dof: int
    rms_um: float
    sigma0_um: float
    chi2_reduced: float | None
    chi2_probability: float | None
    lack_of_fit: LackOfFit | None
    variance_ratio: float
    row_variance_mm2: float | None
    iterations: int
    robust: RobustLoss | None = None

    @property
    def unit_weight_variance(self) -> float:
        """Variance of unit weight: what a covariance that follows from the weights is multiplied with.

        Weights that no uncertainty states are ones, 1/mm; then it is the variance of a row.
        """
        return self.variance_ratio if self.row_variance_mm2 is None else self.row_variance_mm2


@dataclass(frozen=True)
class FitSums:
    """What the statistics need of a fit.

    Attributes:
        n_points: rows used.
        free: number of free parameters.
        square: sum of the squares of the whitened residuals.
        square_mm2: sum of the squares of the residuals, mm².
        weight: sum of the squares of the weights, 1/mm².
        stated: the weights come from stated uncertainties.
        iterations: steps of the solver.
    """

    n_points: int
    free: int
    square: float
    square_mm2: float
    weight: float
    stated: bool
    iterations: int


def fit_statistics(fit: WhitenedFit) -> FitStatistics:
    """Return χ², scatter in µm and lack of fit."""
    residuals, weights = fit.residuals_mm, fit.whitening.weights
    sums = FitSums(
        n_points=residuals.size,
        free=fit.free,
        square=fit.square,
        square_mm2=float(residuals @ residuals),
        weight=float(weights @ weights),
        stated=fit.stated,
        iterations=fit.iterations,
    )
    return summed_statistics(sums, lack_of_fit(fit))


def summed_statistics(sums: FitSums, lack: LackOfFit | None) -> FitStatistics:
    """Judge a fit by its sums and, where rows are repeated, by its lack of fit."""
    dof = sums.n_points - sums.free
    probability = chi2_probability(sums.square, dof) if sums.stated else None
    variance = sums.square / dof
    factor = _unit_weight_variance(variance, probability, lack)
    return FitStatistics(
        n_points=sums.n_points,
        n_parameters=sums.free,
        dof=dof,
        rms_um=1e3 * float(np.sqrt(sums.square_mm2 / sums.n_points)),
        sigma0_um=1e3 * float(np.sqrt(variance / (sums.weight / sums.n_points))),
        chi2_reduced=variance if sums.stated else None,
        chi2_probability=probability,
        lack_of_fit=lack,
        variance_ratio=factor if sums.stated else 1.0,
        row_variance_mm2=None if sums.stated else factor,
        iterations=sums.iterations,
    )


def _unit_weight_variance(variance: float, probability: float | None, lack: LackOfFit | None) -> float:
    """Return the factor that keeps the stated uncertainties honest.

    Stated uncertainties stand unless the χ² test rejects them; without any, the fit's own scatter is taken. A
    lack of fit that nothing stated explains is common to the repeats and does not average out.
    """
    factor = variance if probability is None or probability < SIGNIFICANCE else 1.0
    if lack is not None and lack.significant:
        factor = max(factor, lack.excess)
    return factor
