"""How much of what a model leaves on a path the stated uncertainties explain."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.comparison import Comparison

WITHIN = 2.0
"""A normalised error within ±2 is expected of 95 in 100."""


@dataclass(frozen=True)
class Agreement:
    """A comparison judged by the uncertainties of the prediction, of the instrument, and of the alignment.

    With the covariance V of measured minus predicted coordinates and the projector P on what no rotation and no shift
    can take up, the differences d that remain have the covariance W = P V P. So trace W is what dᵀd is expected to
    be, and dᵀd / trace W follows χ²/ν with ν = (trace W)² / trace W² degrees of freedom (Satterthwaite).

    Attributes:
        expected_um: 2-D rms expected of the stated uncertainties, µm.
        share: share of the variance left over that they explain; above 1 they are on the safe side.
        dof: effective degrees of freedom ν.
        probability: of differences this large if the stated uncertainties are all there is.
        u_mm: standard uncertainty of each difference, shape (n, 2); NaN where it is not compared.
        normalised: differences over u_mm, shape (n, 2); NaN likewise.
        u_rotation_rad: standard uncertainty of the alignment's rotation.
        u_shift_mm: standard uncertainties of its shift, shape (2,).
        instrument: the instrument has stated its uncertainty at every row; where not, it counts as nothing.
    """

    expected_um: float
    share: float
    dof: float
    probability: float
    u_mm: Floats
    normalised: Floats
    u_rotation_rad: float
    u_shift_mm: Floats
    instrument: bool

    @property
    def agrees(self) -> bool:
        """The stated uncertainties account for what is left."""
        return self.probability >= SIGNIFICANCE

    @property
    def within(self) -> float:
        """Share of the coordinates whose normalised error lies within ±2; NaN without uncertainties."""
        known = self.normalised[np.isfinite(self.normalised)]
        return float(np.mean(np.abs(known) <= WITHIN)) if known.size else math.nan


def agreement(comparison: Comparison, effects_mm: Floats, u_instrument_mm: Floats) -> Agreement:
    """Judge a comparison.

    Args:
        comparison: n rows, m of them compared.
        effects_mm: effects of independent unit errors on the predicted positions of the compared rows, shape
            (m, 2, k); see `catseye.calibration.scara.prediction.position_effects`.
        u_instrument_mm: standard uncertainty of each measured coordinate, shape (n,); NaN where none is stated.
    """
    rows = comparison.inside
    aligned = comparison.aligned_mm[rows]
    stated = np.isfinite(u_instrument_mm[rows])
    white = np.repeat(np.where(stated, u_instrument_mm[rows], 0.0) ** 2, 2)
    effects = effects_mm.reshape(white.size, -1)
    alignment = _alignment(aligned - comparison.transform.shift_mm)
    basis, triangle = np.linalg.qr(alignment)
    left = effects - basis @ (basis.T @ effects)
    shift = np.linalg.solve(triangle, basis.T)
    u_align = np.sqrt(np.sum((shift @ effects) ** 2, axis=1) + shift**2 @ white)
    variance = np.sum(left**2, axis=1) + _projected_white(basis, white)
    difference = comparison.difference_mm[rows].ravel()
    mean, square = float(variance.sum()), float(difference @ difference)
    dof = mean**2 / _trace_of_square(basis, left, white) if mean > 0.0 else 0.0
    u, normalised = (np.full(comparison.difference_mm.shape, np.nan) for _ in range(2))
    u[rows] = np.sqrt(variance).reshape(-1, 2)
    known = u > 0.0
    normalised[known] = comparison.difference_mm[known] / u[known]
    return Agreement(
        expected_um=1e3 * math.sqrt(mean / len(aligned)),
        share=mean / square if square > 0.0 else math.inf,
        dof=dof,
        probability=float(special.chdtrc(dof, square * dof / mean)) if mean > 0.0 else 0.0,
        u_mm=u,
        normalised=normalised,
        u_rotation_rad=float(u_align[2]),
        u_shift_mm=u_align[:2],
        instrument=bool(stated.all()),
    )


def _alignment(turned_mm: Floats) -> Floats:
    """Return how coordinates answer to a shift in x, in y, and to a rotation about the origin, shape (2n, 3)."""
    columns = np.zeros((len(turned_mm), 2, 3))
    columns[:, 0, 0] = columns[:, 1, 1] = 1.0
    columns[:, 0, 2], columns[:, 1, 2] = -turned_mm[:, 1], turned_mm[:, 0]
    return columns.reshape(-1, 3)


def _projected_white(basis: Floats, white: Floats) -> Floats:
    """Return the diagonal of P D P for P = I − Q Qᵀ and a diagonal D, shape (n,)."""
    inner = basis.T @ (white[:, None] * basis)
    own = np.sum(basis**2, axis=1)
    return np.asarray(white * (1.0 - 2.0 * own) + np.sum((basis @ inner) * basis, axis=1))


def _trace_of_square(basis: Floats, left: Floats, white: Floats) -> float:
    """Return the trace of W² for W = E Eᵀ + P D P with E = P E, without building W."""
    inner = left.T @ left
    between = basis.T @ (white[:, None] * basis)
    of_white = (
        float(white @ white) - 2.0 * float(white**2 @ np.sum(basis**2, axis=1)) + float(np.sum(between**2))
    )
    mixed = float(np.sum(left**2 * white[:, None]))
    return float(np.sum(inner**2)) + 2.0 * mixed + of_white
