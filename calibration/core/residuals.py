"""Residuals of single rows: studentised, their leverage, their influence."""

from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.projection import Projection
from catseye.calibration.core.types import Floats

NORMAL_MAD = 0.6744897501960817
"""Median of the modulus of a standard normal error."""

_DETERMINED = 1e-10
"""A row whose leverage comes closer to 1 than this determines a parameter alone; nothing speaks about it."""


@dataclass(frozen=True)
class StudentisedResiduals:
    """Residuals in their own standard deviations; NaN where a row determines a parameter alone.

    A row is judged by what the others predict of it, shared errors included.

    Attributes:
        leverage: share that a row has in the model's answer to it, shape (n,).
        internal: over its standard deviation, the scatter from all residuals, shape (n,).
        external: the same with the scatter from the other residuals; Student's t with dof − 1, shape (n,).
        cook: Cook's distance: how far the estimate moves without the row, in its own confidence region.
        normalised: over its stated standard uncertainty, shape (n,); None when no uncertainty is stated.
    """

    leverage: Floats
    internal: Floats
    external: Floats
    cook: Floats
    normalised: Floats | None


def studentised(projection: Projection, stated: bool) -> StudentisedResiduals:
    """Return the studentised residuals of a fit (Cook and Weisberg, "Residuals and Influence in Regression").

    Args:
        projection: the fit, on the space that its model cannot reach.
    """
    model = projection.whitening.again(projection.orthonormal)
    leverage = np.einsum("ij,ij->i", model, model)
    own = _own(projection)
    scatter = projection.square / projection.dof
    internal = projection.pulls / np.sqrt(own * scatter) if scatter > 0.0 else 0.0 * own
    others = np.maximum(projection.dof - internal**2, 0.0) / max(projection.dof - 1, 1)
    with np.errstate(divide="ignore"):
        external = internal / np.sqrt(others)
    return StudentisedResiduals(
        leverage=leverage,
        internal=internal,
        external=external,
        cook=internal**2 * leverage / (own * model.shape[1]),
        normalised=projection.pulls / np.sqrt(own) if stated else None,
    )


def outlier_probability(external: Floats, dof: int) -> float:
    """Return the probability that any of all externally studentised residuals is this large (Bonferroni)."""
    largest = float(np.max(np.abs(np.nan_to_num(external))))
    return min(1.0, 2.0 * external.size * float(special.stdtr(max(dof - 1, 1), -largest)))


def outlier_limit(rows: int, dof: int, probability: float) -> float:
    """Return the externally studentised residual that one of so many rows exceeds with a probability (Bonferroni)."""
    return -float(special.stdtrit(max(dof - 1, 1), probability / 2.0 / rows))


def robustly_studentised(projection: Projection) -> Floats:
    """Return externally studentised residuals with a robust scale, shape (n,); NaN where a row stands alone.

    The scale is 1.4826 times the median modulus of the studentised residuals, which outliers hardly move.
    """
    raw = projection.pulls / np.sqrt(_own(projection))
    scale = float(np.nanmedian(np.abs(raw))) / NORMAL_MAD
    return raw / max(scale, 1e-9 * float(np.mean(projection.weights)))


def _own(projection: Projection) -> Floats:
    return np.where(projection.own > _DETERMINED, projection.own, np.nan)
