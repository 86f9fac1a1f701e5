"""F-test of a fit against the scatter of rows that repeat each other."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg, special

from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.significance import Judged
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening, through_sources

_EXACT_MM = 1e-9
"""Scatter below this is rounding, not measurement."""

_RANK_SQUARED = 1e-12
"""Squared singular values of unit columns within groups: where the levels explain a column, rounding leaves less."""


@dataclass(frozen=True)
class WhitenedFit:
    """A fit, and what makes its rows independent.

    Attributes:
        whitening: of the rows; in units of 1 mm when no uncertainty is stated.
        stated: the whitening comes from stated uncertainties.
        repeats: which rows measure the same.
        residuals_mm: predicted minus measured, shape (n,).
        jacobian: derivatives of the residuals, shape (n, p).
        free: number of free parameters.
        iterations: steps of the solver.
    """

    whitening: Whitening
    stated: bool
    repeats: Repeats
    residuals_mm: Floats
    jacobian: Floats
    free: int
    iterations: int

    @cached_property
    def square(self) -> float:
        """Sum of squares of the whitened residuals."""
        return self.whitening.square(self.residuals_mm)


@dataclass(frozen=True)
class LackOfFit(Judged):
    """F-test of a model against the scatter of repeats, both seen through the stated errors.

    The alternative gives each group of repeats levels of its own and keeps what the model says of differences within
    a group. What it explains beyond the model and the stated errors is systematic: the model lacks it.

    Attributes:
        systematic_um: standard deviation of the systematic part of a row that nothing stated explains, µm.
        pure_um: standard deviation of the pure scatter, µm.
        ratio: F, mean square of the lack over the mean square of the scatter; about 1 when nothing lacks.
        probability: of a ratio this large when model and stated errors are complete.
        excess: mean square of the lack, in units of what is stated.
    """

    systematic_um: float
    pure_um: float
    ratio: float
    probability: float
    excess: float


def lack_of_fit(fit: WhitenedFit) -> LackOfFit | None:
    """Test a fit against repeats.

    Returns:
        None when fewer than 10 degrees of freedom remain for the scatter, or when the fit is exact.
    """
    pure, levels, further = _within_groups(fit)
    rank, rows, weights = levels + further, fit.residuals_mm.size, fit.whitening.weights
    dof_pure, dof_model = rows - rank, rank - fit.free
    if dof_pure < 10 or dof_model < 1:
        return None
    pure_square = pure / dof_pure
    if pure_square <= (_EXACT_MM * float(np.mean(weights))) ** 2:
        return None
    lack_square = max(fit.square - pure, 0.0) / dof_model
    ratio = lack_square / pure_square
    unit_um = 1e3 / float(np.sqrt(np.mean(weights**2)))
    systematic = max(lack_square - pure_square, 0.0) * levels / rows
    return LackOfFit(
        systematic_um=unit_um * float(np.sqrt(systematic)),
        pure_um=unit_um * float(np.sqrt(pure_square)),
        ratio=ratio,
        probability=float(special.fdtrc(dof_model, dof_pure, ratio)),
        excess=lack_square,
    )


def _within_groups(fit: WhitenedFit) -> tuple[float, int, int]:
    """Return what neither the groups' own levels nor the model explain, and the rank of each.

    Errors that repeats share stand in the levels of their groups; what is left of the others within a group is
    whitened there. All of it follows from sums of products.

    Returns:
        Sum of squares of the whitened residuals; the number of levels; the rank that the model adds to theirs.
    """
    weights, effects = fit.whitening.weights, fit.whitening.effects
    weighted = np.column_stack([fit.jacobian, fit.residuals_mm]) * weights[:, None]
    scale = np.linalg.norm(weighted, axis=0)
    within, levels = fit.repeats.within(
        np.column_stack([effects, weighted / np.where(scale > 0.0, scale, 1.0)]), weights
    )
    sources = effects.shape[1]
    left = through_sources(within[sources:, sources:], within[sources:, :sources], within[:sources, :sources])
    values, vectors = linalg.eigh(left[:-1, :-1])
    known = values > _RANK_SQUARED
    along = (vectors[:, known] / np.sqrt(values[known])).T @ left[:-1, -1]
    pure = max(float(left[-1, -1] - along @ along), 0.0)
    return pure * float(scale[-1]) ** 2, levels, int(known.sum())
