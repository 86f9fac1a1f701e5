"""How much each contributor of the budget makes of each result."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import RowErrors
from catseye.calibration.core.coverage import effective_dof
from catseye.calibration.core.fit_statistics import FitStatistics
from catseye.calibration.core.gain import Gain
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Contributions:
    """The covariance of an estimate, taken apart.

    Attributes:
        errors: the contributors, and what the fit widens them by.
        covariances: of the estimate from each contributor alone, widening included, shape (contributors, p, p).
    """

    errors: RowErrors
    covariances: Floats

    @property
    def names(self) -> tuple[str, ...]:
        """In the order of `covariances`."""
        return tuple(one.name for one in self.errors.contributors)

    @property
    def covariance(self) -> Floats:
        """Covariance of the estimate from all contributors, shape (p, p)."""
        return np.asarray(self.covariances.sum(axis=0))

    @property
    def variances(self) -> Floats:
        """Variance that each contributor gives each parameter, shape (contributors, p)."""
        return np.asarray(np.maximum(np.einsum("kii->ki", self.covariances), 0.0))

    def effective_dof(self, variances: Floats) -> Floats:
        """Return the effective degrees of freedom of results (Welch–Satterthwaite), shape (m,).

        Args:
            variances: what each contributor gives to each result, shape (contributors, m).
        """
        dof = np.array([one.dof for one in self.errors.contributors])
        # The widening multiplies everything, so it counts as one more input of full size.
        widening = 1.0 / self.errors.factor_dof
        inverse = np.array([1.0 / effective_dof(np.sqrt(v), dof) + widening for v in variances.T])
        return np.where(inverse > 0.0, 1.0 / np.where(inverse > 0.0, inverse, 1.0), math.inf)


def row_errors(model: Model, values: Floats, fit: FitStatistics) -> RowErrors:
    """Return the errors that the covariance of an estimate comes from.

    Args:
        values: the estimate, shape (p,).
    """
    widened = not model.stated or fit.variance_ratio != 1.0
    return RowErrors(
        model.white(values), model.shared(values), fit.unit_weight_variance, fit.dof if widened else math.inf
    )


def taken_apart(model: Model, values: Floats, errors: RowErrors) -> Contributions:
    """Return what each contributor makes of an estimate; the sum is the covariance of the law of propagation.

    Args:
        values: the estimate, shape (p,).
        errors: white and shared, in the order of the rows.
    """
    moved = Gain.at(model, values).matrix
    parts = [moved * one.sigma_mm for one in errors.white] + [moved @ one.effects_mm for one in errors.shared]
    # A product with its own transpose is symmetric to the last digit.
    return Contributions(errors, errors.factor * np.stack([part @ part.T for part in parts]))
