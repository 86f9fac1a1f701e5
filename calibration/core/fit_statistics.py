"""How well a model fits: residual statistics, χ² test, lack of fit against repeated poses."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, special

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.points import Points

SIGNIFICANCE = 0.01
"""A test rejects when its probability is below this."""

_EXACT_MM = 1e-9
"""Scatter below this is rounding, not measurement."""

_RANK_SQUARED = 1e-12
"""Squared singular values below this share of the largest count as zero."""


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
        expected_ratio: F that the stated systematic contributors let expect; 1 when none are stated.
        probability: of a ratio this large when the model is complete and errors are white.
        probability_stated: of a ratio this large when the stated systematic contributors act too.
        excess: mean square of the lack over what the stated contributors let expect.
    """

    dof_model: int
    dof_pure: int
    systematic_um: float
    pure_um: float
    ratio: float
    expected_ratio: float
    probability: float
    probability_stated: float
    excess: float

    @property
    def significant(self) -> bool:
        """The model lacks something that the repeats show."""
        return self.probability < SIGNIFICANCE

    @property
    def explained(self) -> bool:
        """The stated systematic contributors account for it."""
        return self.probability_stated >= SIGNIFICANCE


@dataclass(frozen=True)
class RobustLoss:
    """What a robust loss made of the distances.

    Attributes:
        name: "huber" or "soft-l1".
        sigma_um: robust standard deviation of a distance, µm.
        half: residual that counts half, in robust standard deviations.
        counted_little: distances that count less than half.
    """

    name: str
    sigma_um: float
    half: float
    counted_little: int


@dataclass(frozen=True)
class FitStatistics:
    """Quality of a fit.

    Attributes:
        n_points: distances used.
        n_parameters: free parameters, the gauge's constraint taken off.
        dof: degrees of freedom.
        rms_um: rms of the residuals, µm.
        sigma0_um: standard deviation of a distance estimated from the fit, µm.
        chi2_reduced: χ² / dof for the stated white uncertainties; None when none were stated.
        chi2_expected: what the stated uncertainties, systematic ones included, let expect.
        chi2_probability: of a χ² this large; None when no uncertainties were stated.
        lack_of_fit: test against repeats; None when too few poses are repeated.
        variance_factor: what the covariance of the stated uncertainties was multiplied with.
        iterations: steps of the solver.
        loss: of a robust fit; None for least squares.
    """

    n_points: int
    n_parameters: int
    dof: int
    rms_um: float
    sigma0_um: float
    chi2_reduced: float | None
    chi2_expected: float
    chi2_probability: float | None
    lack_of_fit: LackOfFit | None
    variance_factor: float
    iterations: int
    loss: RobustLoss | None = None


@dataclass(frozen=True)
class WeightedFit:
    """A fit in units of the stated white uncertainties (of 1 mm when none are stated).

    Attributes:
        points: what was measured, n rows.
        residuals: weighted residuals, shape (n,).
        jacobian: weighted Jacobian, shape (n, p).
        effects: weighted effects of systematic contributors that the fit leaves over, shape (n, m).
        free: number of free parameters.
        iterations: steps of the solver.
        bidirectional: the model knows directions of approach; otherwise only visits from the same directions are
            repeats.
    """

    points: Points
    residuals: Floats
    jacobian: Floats
    effects: Floats
    free: int
    iterations: int
    bidirectional: bool = True

    @property
    def weights(self) -> Floats:
        """Reciprocal standard uncertainties, shape (n,)."""
        return point_weights(self.points)


def point_weights(points: Points) -> Floats:
    """Return reciprocal standard uncertainties, 1/mm, shape (n,); ones when none are stated."""
    return np.ones(len(points)) if points.sigma_mm is None else 1.0 / points.sigma_mm


@dataclass(frozen=True)
class FitSums:
    """What the statistics need of a fit.

    Attributes:
        n_points: distances used.
        free: number of free parameters.
        square: sum of the squares of the weighted residuals.
        square_mm2: sum of the squares of the residuals, mm².
        weight: sum of the squares of the weights, 1/mm².
        inner: products of the weighted effects that the fit leaves over, EᵀE or EEᵀ.
        stated: the weights come from stated uncertainties.
        iterations: steps of the solver.
    """

    n_points: int
    free: int
    square: float
    square_mm2: float
    weight: float
    inner: Floats
    stated: bool
    iterations: int


def fit_statistics(fit: WeightedFit) -> FitStatistics:
    """Judge a fit."""
    weights = fit.weights
    sums = FitSums(
        n_points=len(fit.points),
        free=fit.free,
        square=float(fit.residuals @ fit.residuals),
        square_mm2=float(np.sum((fit.residuals / weights) ** 2)),
        weight=float(np.sum(weights**2)),
        inner=_smaller_product(fit.effects),
        stated=fit.points.sigma_mm is not None,
        iterations=fit.iterations,
    )
    return summed_statistics(sums, lack_of_fit(fit))


def summed_statistics(sums: FitSums, lack: LackOfFit | None) -> FitStatistics:
    """Judge a fit by its sums and, where poses are repeated, by its lack of fit."""
    dof = sums.n_points - sums.free
    expected = Expected.of_products(dof, sums.inner)
    probability = expected.probability(sums.square) if sums.stated else None
    variance = sums.square / dof
    return FitStatistics(
        n_points=sums.n_points,
        n_parameters=sums.free,
        dof=dof,
        rms_um=1e3 * float(np.sqrt(sums.square_mm2 / sums.n_points)),
        sigma0_um=1e3 * float(np.sqrt(variance / (sums.weight / sums.n_points))),
        chi2_reduced=variance if sums.stated else None,
        chi2_expected=expected.mean / dof,
        chi2_probability=probability,
        lack_of_fit=lack,
        variance_factor=_variance_factor(variance, expected.mean / dof, probability, lack),
        iterations=sums.iterations,
    )


def _smaller_product(effects: Floats) -> Floats:
    """Return EᵀE or EEᵀ: both have the same trace and the same sum of squares."""
    return effects.T @ effects if effects.shape[0] > effects.shape[1] else effects @ effects.T


def _variance_factor(
    variance: float, expected: float, probability: float | None, lack: LackOfFit | None
) -> float:
    """Return the factor that keeps the stated uncertainties honest.

    Stated uncertainties stand unless the χ² test rejects them; without any, the fit's own scatter is taken. A
    lack of fit that nothing stated explains is common to the repeats of a pose and does not average out.
    """
    factor = 1.0
    if probability is None:
        factor = variance
    elif probability < SIGNIFICANCE:
        factor = variance / expected
    if lack is not None and lack.significant and not lack.explained:
        factor = max(factor, lack.excess)
    return factor


@dataclass(frozen=True)
class Expected:
    """A sum of squares of white and systematic errors: its mean and its effective degrees of freedom.

    Attributes:
        mean: expected sum of squares, in squares of the white uncertainty.
        dof: degrees of freedom of the χ² distribution of the same mean and spread.
    """

    mean: float
    dof: float

    @classmethod
    def of(cls, dof: int, effects: Floats) -> "Expected":
        """Return what `dof` white errors and projected effects of shape (n, m) let expect (Satterthwaite)."""
        return cls.of_products(dof, _smaller_product(effects))

    @classmethod
    def of_products(cls, dof: int, inner: Floats) -> "Expected":
        """Return the same from the effects' products, EᵀE or EEᵀ."""
        mean = dof + float(np.trace(inner))
        return cls(mean, mean**2 / (dof + 2.0 * float(np.trace(inner)) + float(np.sum(inner**2))))

    def minus(self, part: "Expected", dof: int, inner: Floats) -> "Expected":
        """Return the expectation of the difference of two nested sums of squares."""
        mean = self.mean - part.mean
        spread = dof + 2.0 * float(np.trace(inner)) + float(np.sum(inner**2))
        return Expected(mean, mean**2 / spread)

    def probability(self, square: float) -> float:
        """Return the probability of a sum of squares this large."""
        return float(special.chdtrc(self.dof, square * self.dof / self.mean))


def lack_of_fit(fit: WeightedFit) -> LackOfFit | None:
    """Test a fit against repeated poses.

    Returns:
        None when fewer than 10 degrees of freedom remain for the scatter, or when the fit is exact.
    """
    within, poses, further = _within_poses(fit)
    pure, pure_effects, rank = within[:, 0], within[:, 1:], poses + further
    dof_pure, dof_model = len(fit.points) - rank, rank - fit.free
    if dof_pure < 10 or dof_model < 1:
        return None
    pure_square = float(pure @ pure) / dof_pure
    if pure_square <= (_EXACT_MM * float(np.mean(fit.weights))) ** 2:
        return None
    whole = Expected.of(len(fit.points) - fit.free, fit.effects)
    scatter = Expected.of(dof_pure, pure_effects)
    inner = fit.effects.T @ fit.effects - pure_effects.T @ pure_effects
    lack = whole.minus(scatter, dof_model, inner)
    lack_square = max(float(fit.residuals @ fit.residuals - pure @ pure), 0.0) / dof_model
    return _judged(fit, lack_square, pure_square, (dof_model, dof_pure), lack, scatter, poses)


def _judged(
    fit: WeightedFit,
    lack_square: float,
    pure_square: float,
    dofs: tuple[int, int],
    lack: Expected,
    scatter: Expected,
    poses: int,
) -> LackOfFit:
    dof_model, dof_pure = dofs
    ratio = lack_square / pure_square
    expected_ratio = (lack.mean / dof_model) / (scatter.mean / dof_pure)
    unit_um = 1e3 / float(np.sqrt(np.mean(fit.weights**2)))
    systematic = max(lack_square - pure_square, 0.0) * poses / len(fit.points)
    return LackOfFit(
        dof_model=dof_model,
        dof_pure=dof_pure,
        systematic_um=unit_um * float(np.sqrt(systematic)),
        pure_um=unit_um * float(np.sqrt(pure_square)),
        ratio=ratio,
        expected_ratio=expected_ratio,
        probability=float(special.fdtrc(dof_model, dof_pure, ratio)),
        probability_stated=float(special.fdtrc(lack.dof, scatter.dof, ratio / expected_ratio)),
        excess=lack_square * dof_model / lack.mean,
    )


def _pose_groups(fit: WeightedFit) -> Ints:
    """Return the number of what each point repeats: reflector, dead path, θ1, θ2, shape (n,)."""
    points, commands = fit.points, fit.points.commands
    key = np.zeros(len(points), dtype=np.int64)
    columns = [points.reflector, points.dead_path]
    columns += [np.round(commands.theta1_rad, 9), np.round(commands.theta2_rad, 9)]
    if not fit.bidirectional:
        columns += [commands.direction1, commands.direction2]
    for column in columns:
        values, number = np.unique(column, return_inverse=True)
        key = key * values.size + number
    return np.asarray(np.unique(key, return_inverse=True)[1], dtype=np.int64)


def _within_poses(fit: WeightedFit) -> tuple[Floats, int, int]:
    """Return what neither the poses' own levels nor the model explain, and the rank of each.

    Returns:
        Residuals in the first column, systematic effects in the others, shape (n, 1 + m); the number of poses; the
        rank that the model adds to theirs.
    """
    group, weights = _pose_groups(fit), fit.weights
    stacked = np.column_stack([fit.jacobian, fit.residuals, fit.effects])
    within = stacked - weights[:, None] * _levels(stacked * weights[:, None], weights**2, group)[group]
    n_parameters = fit.jacobian.shape[1]
    scale = np.linalg.norm(fit.jacobian, axis=0)
    model = within[:, :n_parameters] / np.where(scale > 0.0, scale, 1.0)
    rest = within[:, n_parameters:]
    values, vectors = linalg.eigh(model.T @ model)
    known = values > _RANK_SQUARED * values[-1]
    directions = vectors[:, known] / np.sqrt(values[known])
    explained = model @ (directions @ (directions.T @ (model.T @ rest)))
    return rest - explained, int(group.max()) + 1, int(known.sum())


def _levels(weighted: Floats, squares: Floats, group: Ints) -> Floats:
    """Return the weighted means of columns over groups, shape (groups, columns)."""
    order = np.argsort(group, kind="stable")
    starts = np.flatnonzero(np.diff(group[order], prepend=-1))
    sums = np.add.reduceat(weighted[order], starts, axis=0)
    return np.asarray(sums / np.add.reduceat(squares[order], starts)[:, None], dtype=np.float64)
