"""How much of what a model leaves on a path the stated uncertainties explain."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.budget import White
from catseye.calibration.core.quadratic_form import SumOfSquares
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import INSTRUMENT
from catseye.calibration.scara.comparison import Comparison
from catseye.calibration.scara.prediction_errors import PredictionErrors

WITHIN = 2.0
"""A normalised error within ±2 is expected of 95 in 100."""


@dataclass(frozen=True)
class Agreement:
    """A comparison judged by the uncertainties of prediction, arm, instrument and alignment.

    With the covariance V of measured minus predicted coordinates and the projector P on what no rotation and no shift
    can take up, the differences d that remain have the covariance W = P V P. So trace W is what dᵀd is expected to
    be; its probability is that of a sum of χ² variables in the sizes of W's eigenvalues.

    Attributes:
        expected_um: 2-D rms expected of the stated uncertainties, µm.
        parts_um: what each contributor alone makes of it, µm; the squares add up to that of the whole.
        share: share of the variance left over that they explain; above 1 they are on the safe side.
        dof: effective degrees of freedom of that sum, (trace W)² / trace W².
        probability: of differences this large if the stated uncertainties are all there is.
        u_mm: standard uncertainty of each difference, shape (n, 2); NaN where it is not compared.
        normalised: differences over u_mm, shape (n, 2); NaN likewise.
        u_rotation_rad: standard uncertainty of the alignment's rotation.
        u_shift_mm: standard uncertainties of its shift, shape (2,).
        instrument: the instrument has stated its uncertainty at every row; where not, it counts as nothing.
    """

    expected_um: float
    parts_um: Mapping[str, float]
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


def agreement(comparison: Comparison, errors: PredictionErrors, u_instrument_mm: Floats) -> Agreement:
    """Judge a comparison.

    Args:
        comparison: n rows, m of them compared.
        errors: of x and y of the compared rows in turn, 2m rows.
        u_instrument_mm: standard uncertainty of each measured coordinate, shape (n,); NaN where none is stated.
    """
    rows = comparison.inside
    aligned = comparison.aligned_mm[rows]
    stated = np.isfinite(u_instrument_mm[rows])
    instrument = White(INSTRUMENT, np.repeat(np.where(stated, u_instrument_mm[rows], 0.0), 2))
    errors = replace(errors, white=(*errors.white, instrument))
    white, effects = errors.white_mm2, errors.effects_mm
    alignment = _alignment(aligned - comparison.transform.shift_mm)
    basis, triangle = np.linalg.qr(alignment)
    left = effects - basis @ (basis.T @ effects)
    shift = np.linalg.solve(triangle, basis.T)
    u_align = np.sqrt(np.sum((shift @ effects) ** 2, axis=1) + shift**2 @ white)
    variance = np.sum(left**2, axis=1) + _projected_white(basis, white)
    difference = comparison.difference_mm[rows].ravel()
    expected, square = SumOfSquares.of(effects, white, basis), float(difference @ difference)
    u, normalised = (np.full(comparison.difference_mm.shape, np.nan) for _ in range(2))
    u[rows] = np.sqrt(variance).reshape(-1, 2)
    known = u > 0.0
    normalised[known] = comparison.difference_mm[known] / u[known]
    return Agreement(
        expected_um=1e3 * math.sqrt(expected.mean / len(aligned)),
        parts_um={
            name: 1e3 * math.sqrt(square_mm2 / len(aligned)) for name, square_mm2 in _traces(basis, errors)
        },
        share=expected.mean / square if square > 0.0 else math.inf,
        dof=expected.dof,
        probability=expected.probability(square),
        u_mm=u,
        normalised=normalised,
        u_rotation_rad=float(u_align[2]),
        u_shift_mm=u_align[:2],
        instrument=bool(stated.all()),
    )


def _traces(basis: Floats, errors: PredictionErrors) -> Iterator[tuple[str, float]]:
    """Return what each contributor gives to the trace of W, mm²."""
    for shared in errors.shared:
        left = shared.effects_mm - basis @ (basis.T @ shared.effects_mm)
        yield shared.name, float(np.sum(left**2))
    for white in errors.white:
        yield white.name, float(_projected_white(basis, white.sigma_mm**2).sum())


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
