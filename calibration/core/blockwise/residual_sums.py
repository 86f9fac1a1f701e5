"""What is kept of millions of residuals: sums by group, and how they are distributed."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints

BINS = 41
"""Bins of the histogram; the first and the last hold all that lies beyond."""


@dataclass(frozen=True)
class ResidualSums:
    """Residuals (predicted minus measured) of all rows, summed up.

    Attributes:
        count: rows of each group, shape (k,).
        total_mm: sums of their residuals, mm, shape (k,).
        square_mm2: sums of the squares, mm², shape (k,).
        largest_mm: largest absolute residuals, mm, shape (k,).
        half_width_mm: half the width that the histogram covers, mm.
        histogram: numbers of residuals from -half_width_mm to half_width_mm, shape (BINS,).
    """

    count: Ints
    total_mm: Floats
    square_mm2: Floats
    largest_mm: Floats
    half_width_mm: float
    histogram: Ints

    @classmethod
    def empty(cls, groups: int, half_width_mm: float) -> "ResidualSums":
        """Return sums over nothing."""
        zeros = np.zeros(groups)
        none = np.zeros(groups, dtype=np.int64)
        return cls(none, zeros, zeros, zeros, half_width_mm, np.zeros(BINS, dtype=np.int64))

    def plus(self, residuals_mm: Floats, group: Ints) -> "ResidualSums":
        """Return the sums with a block added."""
        size, largest = self.count.size, self.largest_mm.copy()
        np.maximum.at(largest, group, np.abs(residuals_mm))
        place = np.floor((residuals_mm / self.half_width_mm + 1.0) * (BINS / 2)).clip(0, BINS - 1)
        return ResidualSums(
            self.count + np.bincount(group, minlength=size),
            self.total_mm + np.bincount(group, residuals_mm, size),
            self.square_mm2 + np.bincount(group, residuals_mm**2, size),
            largest,
            self.half_width_mm,
            self.histogram + np.bincount(place.astype(np.int64), minlength=BINS),
        )

    @property
    def rows(self) -> int:
        """Over all groups."""
        return int(self.count.sum())

    @property
    def rms_mm(self) -> float:
        """Rms of all residuals, mm."""
        return float(np.sqrt(self.square_mm2.sum() / self.rows))
