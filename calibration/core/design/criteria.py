"""What makes a plan good: one number of the covariance, and the uncertainty that it stands for."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import require_count, require_one_of, require_shape
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats

CriterionName = Literal["A", "D", "E", "path"]

_TINY = 1e-14
"""Added to the diagonal of scaled information, so that a singular matrix has a huge covariance instead of none."""

SINGULAR = 1.0
"""Variances from this on stand for a direction that no row determines; free directions are scaled far below it."""

_LARGEST_INFLATION = 1e11
"""A variance that is more times what it would be if everything else were known stands for such a direction too: with
_TINY an exactly singular matrix comes to 1e14, shared among the parameters of the direction. However small the stated
uncertainties are, this shows it."""


@dataclass(frozen=True)
class Criterion:
    """A criterion of optimal design; smaller is better.

    With C the covariance in the free directions, scaled to one unit, in terms of optimal design:
        A: trace of C. D: log det C. E: largest eigenvalue of C.
        path: largest variance of stated combinations, g C gᵀ (a G-criterion).
    Each is a convex function of the information.

    Attributes:
        name: which.
        parameters: number of parameters, the gauge's constraint included.
        gradient: derivatives of the combinations by the free directions, shape (q, f); empty without any.
    """

    name: CriterionName
    parameters: int
    gradient: Floats

    def __post_init__(self) -> None:
        require_one_of(CriterionName, self.name, "criterion")
        require_count(self.parameters, "parameters")
        require_shape(self.gradient, (None, None), "gradient")
        if self.name == "path" and not len(self.gradient):
            raise ArgumentError("criterion path needs the combinations that it judges: state their gradient")

    def value(self, covariance: Floats) -> Floats:
        """Return the value of covariances of shape (..., f, f), shape (...); infinite where singular."""
        diagonal = np.diagonal(covariance, axis1=-2, axis2=-1)
        match self.name:
            case "A":
                value = diagonal.sum(axis=-1)
            case "D":
                value = np.linalg.slogdet(covariance)[1]
            case "E":
                value = np.linalg.eigvalsh(covariance)[..., -1]
            case "path":
                value = ((self.gradient @ covariance) * self.gradient).sum(axis=-1).max(axis=-1)
        regular = (diagonal.max(axis=-1) < SINGULAR) & (diagonal.min(axis=-1) > 0.0)
        return np.asarray(np.where(regular, value, np.inf), dtype=np.float64)

    def standard_uncertainty(self, value: float) -> float:
        """Return the standard uncertainty that a value stands for, in the unit of the covariance's root."""
        match self.name:
            case "A":
                return float(np.sqrt(value / self.parameters))
            case "D":
                # log det is the sum over the free directions; half of it is that of standard uncertainties.
                return float(np.exp(0.5 * value / self.free))
            case _:
                return float(np.sqrt(value))

    @property
    def free(self) -> int:
        """Number of free directions."""
        return int(self.gradient.shape[1])

    def slope(self, covariance: Floats) -> Floats:
        """Return minus the derivative of the value by the information, shape (f, f).

        Args:
            covariance: the inverse of the information, shape (f, f).
        """
        match self.name:
            case "A":
                return covariance @ covariance
            case "D":
                return covariance
            case "E":
                values, vectors = np.linalg.eigh(covariance)
                return np.asarray(values[-1] ** 2 * np.outer(vectors[:, -1], vectors[:, -1]))
            case "path":
                sides = self.gradient @ covariance
                worst = sides[int(np.argmax((sides * self.gradient).sum(axis=1)))]
                return np.outer(worst, worst)


def covariances(matrix: Floats) -> Floats:
    """Return the covariances of information of shape (..., f, f).

    Returns:
        Covariances, shape (..., f, f); where the information is singular, variances of at least SINGULAR.
    """
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    both = scale[..., :, None] * scale[..., None, :]
    identity = np.eye(matrix.shape[-1])
    scaled = np.linalg.inv(matrix * both + _TINY * identity)
    inflation = np.abs(np.diagonal(scaled, axis1=-2, axis2=-1)).max(axis=-1)
    undetermined = (inflation > _LARGEST_INFLATION)[..., None, None]
    return np.asarray(np.where(undetermined, SINGULAR * identity, both * scaled), dtype=np.float64)


def pareto_front(costs: Floats) -> Bools:
    """Return which rows no other row beats: none is as good in everything and better in something, shape (n,).

    Args:
        costs: what should be small, shape (n, quantities).
    """
    as_good = np.all(costs[None, :, :] <= costs[:, None, :], axis=2)
    better = np.any(costs[None, :, :] < costs[:, None, :], axis=2)
    return np.asarray(~np.any(as_good & better, axis=1), dtype=np.bool_)
