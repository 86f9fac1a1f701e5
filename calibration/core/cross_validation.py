"""Cross-validation: what the other rows predict of a group of rows.

No fold is solved again. With Q and the pulls Q r of a fit (`Projection`), what the others predict of a fold minus
what was measured is Q_gg⁺ times its pulls, model and shared errors together; where a direction of the fold determines
parameters that no other row depends on, the pseudo-inverse is the fit of these from the fold's own data.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.projection import Projection
from catseye.calibration.core.significance import SIGNIFICANCE, adjusted, f_test
from catseye.calibration.core.types import Bools, Floats, Ints

_OWN = 1e-9
"""1 − σ² of a direction that the fold alone determines, σ a singular value of its part of the basis."""

_WEAK = 10.0
"""A fold whose prediction is expected to be this many times worse than its fit says nothing of the model."""


@dataclass(frozen=True)
class Folds:
    """A way to leave something out.

    Attributes:
        way: what is left out at a time.
        group: number of each row's fold, shape (n,).
        own: parameters of each fold that no row outside of it depends on, shape (folds,).
    """

    way: str
    names: tuple[str, ...]
    group: Ints
    own: Ints

    def rows(self, fold: int) -> Ints:
        """Return the numbers of the rows that a fold leaves out."""
        return np.flatnonzero(self.group == fold)


@dataclass(frozen=True)
class Fold:
    """One part that was left out.

    Attributes:
        name: what it is.
        rows: its rows.
        in_sample_um: rms of its residuals in the fit, µm.
        predicted_um: rms of what the others predict of it minus what was measured, µm; NaN when not identified.
        expected_um: rms expected of the stated uncertainties, scaled to the fit's scatter, µm.
        identified: the others determine what all have in common.
        probability: of a prediction this bad, corrected for the number of folds.
    """

    name: str
    rows: int
    in_sample_um: float
    predicted_um: float
    expected_um: float
    identified: bool
    probability: float

    @property
    def weak(self) -> bool:
        """The others say next to nothing about it."""
        return self.identified and self.expected_um > _WEAK * self.in_sample_um

    @property
    def fails(self) -> bool:
        """The others predict it worse than their uncertainties explain."""
        return self.identified and self.probability < SIGNIFICANCE


@dataclass(frozen=True)
class CrossValidation:
    """All folds of one way to leave something out.

    Attributes:
        way: what is left out at a time.
        folds: each of them.
        predicted_um: rms of all predictions, weak folds left out, µm; NaN when no fold is left.
        in_sample_um: rms of the same rows in the fit, µm.
        expected_um: rms expected of the predictions, µm.
    """

    way: str
    folds: tuple[Fold, ...]
    predicted_um: float
    in_sample_um: float
    expected_um: float


def cross_validation(projection: Projection, folds: Folds) -> CrossValidation:
    """Leave out each fold in turn.

    Args:
        projection: the fit, on the space that its model cannot reach.
    """
    found = [_fold(projection, folds, i) for i in range(len(folds.names))]
    used = [fold for fold in found if fold.identified and not fold.weak]
    return CrossValidation(
        folds.way,
        tuple(found),
        _pooled([fold.predicted_um for fold in used], used),
        _pooled([fold.in_sample_um for fold in used], used),
        _pooled([fold.expected_um for fold in used], used),
    )


def predicted_residuals(projection: Projection, folds: Folds) -> Floats:
    """Return what the others predict of each row minus what was measured, mm, shape (n,).

    NaN where the others do not determine what all have in common.
    """
    predicted = np.full(folds.group.size, np.nan)
    for i in range(len(folds.names)):
        left_out, rows = _LeftOut.of(projection, folds, i), folds.rows(i)
        if left_out.identified:
            predicted[rows] = left_out.predict(projection.pulls[rows]) / projection.weights[rows]
    return predicted


def _pooled(values_um: list[float], folds: list[Fold]) -> float:
    if not folds:
        return float("nan")
    rows = np.array([fold.rows for fold in folds], dtype=np.float64)
    return float(np.sqrt(np.sum(rows * np.square(values_um)) / rows.sum()))


@dataclass(frozen=True)
class _LeftOut:
    """Algebra of one fold: principal directions of its part R of the reach.

    Attributes:
        reach: R, shape (rows, k).
        directions: right singular vectors of R as columns, shape (k, the lesser of rows and k).
        shares: its squared singular values σ², how far the fold is taken along them.
        identified: what others share is determined without the fold.
    """

    reach: Floats
    directions: Floats
    shares: Floats
    identified: bool

    @classmethod
    def of(cls, projection: Projection, folds: Folds, fold: int) -> "_LeftOut":
        reach = projection.reach[folds.rows(fold)]
        _, singular, right = np.linalg.svd(reach, full_matrices=False)
        shares, directions = singular**2, right.T
        alone = int(np.sum(1.0 - shares < _OWN))
        return cls(reach, directions, np.clip(shares, 0.0, 1.0), alone == int(folds.own[fold]))

    @property
    def _alone(self) -> Bools:
        return 1.0 - self.shares < _OWN

    @property
    def _grown(self) -> Floats:
        """Eigenvalues of Q_gg⁺ less one, over the shares; −1 where the fold fits its own parameters."""
        alone = self._alone
        return np.where(alone, -1.0, 1.0 / np.where(alone, 1.0, 1.0 - self.shares))

    @property
    def rank(self) -> int:
        """Directions that the others predict."""
        return len(self.reach) - int(self._alone.sum())

    def predict(self, pulls: Floats) -> Floats:
        """Return Q_gg⁺ times pulls of shape (rows,)."""
        along = self.directions.T @ (self.reach.T @ pulls)
        return np.asarray(pulls + self.reach @ (self.directions @ (along * self._grown)), dtype=np.float64)

    def expected(self) -> float:
        """Return the mean of the predictions' sum of squares, for errors as stated."""
        return float(len(self.reach) + self.shares @ self._grown)


def _fold(projection: Projection, folds: Folds, fold: int) -> Fold:
    left_out, rows, name = _LeftOut.of(projection, folds, fold), folds.rows(fold), folds.names[fold]
    weights, pulls = projection.weights[rows], projection.pulls[rows]
    in_sample_um = 1e3 * float(np.sqrt(np.mean((pulls / weights) ** 2)))
    rest_dof = projection.dof - left_out.rank
    if not left_out.identified or projection.square <= 0.0 or left_out.rank < 1 or rest_dof < 1:
        return Fold(name, int(rows.size), in_sample_um, float("nan"), float("nan"), left_out.identified, 1.0)
    predicted = left_out.predict(pulls)
    gain = float(predicted @ pulls)
    # What a fit without the fold leaves of the others is the whole sum of squares less that of the predictions.
    test = f_test(gain, left_out.rank, max(projection.square - gain, 0.0), rest_dof)
    unit_um = 1e3 / float(np.sqrt(np.mean(weights**2)))
    return Fold(
        name=name,
        rows=int(rows.size),
        in_sample_um=in_sample_um,
        predicted_um=1e3 * float(np.sqrt(np.mean((predicted / weights) ** 2))),
        expected_um=unit_um * float(np.sqrt(test.scale * left_out.expected() / rows.size)),
        identified=True,
        probability=adjusted(test.probability, len(folds.names)),
    )
