"""F-test of a fit against the scatter of rows that repeat each other."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, special

from catseye.calibration.core.centred_sums import group_sums
from catseye.calibration.core.significance import Expected, Judged
from catseye.calibration.core.types import Floats, Ints

_EXACT_MM = 1e-9
"""Scatter below this is rounding, not measurement."""

_RANK_SQUARED = 1e-12
"""Squared singular values below this share of the largest count as zero."""


@dataclass(frozen=True)
class WeightedFit:
    """A fit in units of the stated white uncertainties (of 1 mm when none are stated).

    Attributes:
        weights: reciprocal white standard uncertainties, 1/mm, shape (n,).
        stated: the weights are stated uncertainties.
        repeats: number of what each row measures, equal for repeats, shape (n,).
        residuals: weighted residuals, shape (n,).
        jacobian: weighted Jacobian, shape (n, p).
        effects: weighted effects of shared errors that the fit leaves over, shape (n, m).
        free: number of free parameters.
        iterations: steps of the solver.
    """

    weights: Floats
    stated: bool
    repeats: Ints
    residuals: Floats
    jacobian: Floats
    effects: Floats
    free: int
    iterations: int


@dataclass(frozen=True)
class LackOfFit(Judged):
    """F-test of a model against the scatter of repeats.

    The alternative gives each group of repeats a level of its own and keeps what the model says of differences within
    a group. What it explains beyond the model is systematic: the model lacks it.

    Attributes:
        systematic_um: standard deviation of the systematic part of a row, µm.
        pure_um: standard deviation of the pure scatter, µm.
        ratio: F, mean square of the lack over the mean square of the scatter.
        expected_ratio: F expected of the stated shared errors; 1 when none are stated.
        probability: of a ratio this large when the model is complete and errors are white.
        probability_stated: of a ratio this large when the stated shared errors act too.
        excess: mean square of the lack over what is expected of the stated errors.
    """

    systematic_um: float
    pure_um: float
    ratio: float
    expected_ratio: float
    probability: float
    probability_stated: float
    excess: float


def lack_of_fit(fit: WeightedFit) -> LackOfFit | None:
    """Test a fit against repeats.

    Returns:
        None when fewer than 10 degrees of freedom remain for the scatter, or when the fit is exact.
    """
    within, groups, further = _within_groups(fit)
    pure, pure_effects, rank = within[:, 0], within[:, 1:], groups + further
    dof_pure, dof_model = fit.repeats.size - rank, rank - fit.free
    if dof_pure < 10 or dof_model < 1:
        return None
    pure_square = float(pure @ pure) / dof_pure
    if pure_square <= (_EXACT_MM * float(np.mean(fit.weights))) ** 2:
        return None
    whole = Expected.of(fit.repeats.size - fit.free, fit.effects)
    scatter = Expected.of(dof_pure, pure_effects)
    inner = fit.effects.T @ fit.effects - pure_effects.T @ pure_effects
    lack = whole.minus(scatter, dof_model, inner)
    lack_square = max(float(fit.residuals @ fit.residuals - pure @ pure), 0.0) / dof_model
    return _judged(fit, lack_square, pure_square, (dof_model, dof_pure), lack, scatter, groups)


def _judged(
    fit: WeightedFit,
    lack_square: float,
    pure_square: float,
    dofs: tuple[int, int],
    lack: Expected,
    scatter: Expected,
    groups: int,
) -> LackOfFit:
    dof_model, dof_pure = dofs
    ratio = lack_square / pure_square
    expected_ratio = (lack.mean / dof_model) / (scatter.mean / dof_pure)
    unit_um = 1e3 / float(np.sqrt(np.mean(fit.weights**2)))
    systematic = max(lack_square - pure_square, 0.0) * groups / fit.repeats.size
    return LackOfFit(
        systematic_um=unit_um * float(np.sqrt(systematic)),
        pure_um=unit_um * float(np.sqrt(pure_square)),
        ratio=ratio,
        expected_ratio=expected_ratio,
        probability=float(special.fdtrc(dof_model, dof_pure, ratio)),
        probability_stated=float(special.fdtrc(lack.dof, scatter.dof, ratio / expected_ratio)),
        excess=lack_square * dof_model / lack.mean,
    )


def _within_groups(fit: WeightedFit) -> tuple[Floats, int, int]:
    """Return what neither the groups' own levels nor the model explain, and the rank of each.

    Returns:
        Residuals in the first column, effects in the others, shape (n, 1 + m); the number of groups; the
        rank that the model adds to theirs.
    """
    group, weights = fit.repeats, fit.weights
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
    sums = group_sums(np.column_stack([squares, weighted]), group)
    return sums[:, 1:] / sums[:, :1]
