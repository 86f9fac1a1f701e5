"""A constraint that the rows cannot see, and the steps that keep it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Gauge:
    """A reflection (Householder) that turns the constraint's direction into an axis; the other axes keep it.

    Attributes:
        normal: of the reflection I − n nᵀ, of length √2, shape (p,); zeros where there is no constraint.
        axis: that the direction turns into; None where there is no constraint.
    """

    normal: Floats
    axis: int | None

    @classmethod
    def none(cls, size: int) -> "Gauge":
        """Return the gauge of so many parameters that the rows see without a constraint."""
        return cls(np.zeros(size), None)

    @classmethod
    def mean_of(cls, part: slice, size: int) -> "Gauge":
        """Return the gauge that keeps the mean of some of the parameters."""
        direction = np.zeros(size)
        direction[part] = 1.0 / np.sqrt(part.stop - part.start)
        direction[part.start] += 1.0
        return cls(direction * np.sqrt(2.0) / np.linalg.norm(direction), part.start)

    @property
    def free(self) -> int:
        """Number of steps that keep the constraint."""
        return self.normal.size - (self.axis is not None)

    @cached_property
    def basis(self) -> Floats:
        """Orthonormal steps that keep the constraint, shape (p, free)."""
        return self._without(np.eye(self.normal.size) - np.outer(self.normal, self.normal), 1)

    def reduced(self, matrix: Floats) -> Floats:
        """Return BᵀMB for the basis B and a symmetric matrix of shape (p, p), in p² operations."""
        return self._without(self._without(self._reflected(matrix), 0), 1)

    def expanded(self, matrix: Floats) -> Floats:
        """Return BMBᵀ for the basis B and a symmetric matrix of shape (free, free), in p² operations."""
        if self.axis is None:
            return matrix
        return self._reflected(np.insert(np.insert(matrix, self.axis, 0.0, 0), self.axis, 0.0, 1))

    def _reflected(self, matrix: Floats) -> Floats:
        image = matrix @ self.normal
        half = image - 0.5 * float(self.normal @ image) * self.normal
        crossed = np.outer(half, self.normal)
        return np.asarray(matrix - crossed - crossed.T, dtype=np.float64)

    def _without(self, matrix: Floats, side: int) -> Floats:
        return matrix if self.axis is None else np.delete(matrix, self.axis, side)
