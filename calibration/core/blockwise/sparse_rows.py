"""Rows of a Jacobian without the zeros."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from catseye.calibration.core.types import Floats, Ints


@dataclass(frozen=True)
class Slot:
    """One entry of every row: somewhere within a group of columns.

    Attributes:
        start: first column of the group.
        span: number of columns of the group.
        column: place within the group, shape (n,).
        value: the derivative, shape (n,).
    """

    start: int
    span: int
    column: Ints
    value: Floats


@dataclass(frozen=True)
class SparseRows:
    """Residuals of a block of rows and their derivatives.

    Attributes:
        residuals: predicted minus measured, mm, shape (n,).
        slots: what each row of the Jacobian holds.
        size: number of columns.
    """

    residuals: Floats
    slots: tuple[Slot, ...]
    size: int

    def matrix(self) -> "sparse.csr_array[np.float64, tuple[int, int]]":
        """Return the Jacobian, shape (n, size)."""
        rows, entries = self.residuals.size, len(self.slots)
        columns = np.stack([slot.start + slot.column for slot in self.slots], axis=1)
        values = np.stack([slot.value for slot in self.slots], axis=1)
        starts = np.arange(0, rows * entries + 1, entries)
        return sparse.csr_array((values.ravel(), columns.ravel(), starts), shape=(rows, self.size))
