"""Distances of a points file as columns, in the file's units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.results.scara.points import LARGEST_SEGMENT, LARGEST_SIGMA_MM, PointRow
from catseye.calibration.core.types import Floats, Ints


@dataclass(frozen=True)
class PointColumns:
    """A stretch of a points file.

    Attributes:
        reflector: index among the known names; -1 for one that is not known, shape (n,).
        segment: numbers of the unbroken stretches, shape (n,).
        theta1_deg: J1 commands, shape (n,).
        theta2_deg: J2 commands, shape (n,).
        direction1: states of approach of J1, shape (n,).
        direction2: states of approach of J2, shape (n,).
        displacement_mm: distances relative to their segment's zero, shape (n,).
        sigma_mm: standard uncertainties, shape (n,); None when the file has no such column.
    """

    reflector: Ints
    segment: Ints
    theta1_deg: Floats
    theta2_deg: Floats
    direction1: Floats
    direction2: Floats
    displacement_mm: Floats
    sigma_mm: Floats | None

    def __len__(self) -> int:
        """Return the number of distances."""
        return int(self.displacement_mm.size)

    def first_fault(self) -> tuple[int, str] | None:
        """Return the first row with a value that cannot be, and which column it stands in; None if all are sound."""
        sound = {
            "reflector": self.reflector >= 0,
            "segment": np.abs(self.segment) <= LARGEST_SEGMENT,
            "theta1_deg": np.isfinite(self.theta1_deg),
            "theta2_deg": np.isfinite(self.theta2_deg),
            "direction1": np.abs(self.direction1) == 1.0,
            "direction2": np.abs(self.direction2) == 1.0,
            "displacement_mm": np.isfinite(self.displacement_mm),
        }
        if self.sigma_mm is not None:
            sound["sigma_mm"] = (self.sigma_mm > 0.0) & (self.sigma_mm <= LARGEST_SIGMA_MM)
        faults = [(int(np.argmin(good)), name) for name, good in sound.items() if not good.all()]
        return min(faults) if faults else None


def columns_of(rows: Sequence[PointRow], known: Sequence[str], *, with_sigma: bool) -> PointColumns:
    """Return checked rows as columns; their reflectors are known."""
    index = {name: i for i, name in enumerate(known)}
    return PointColumns(
        np.array([index[row.reflector] for row in rows], dtype=np.int64),
        np.array([row.segment for row in rows], dtype=np.int64),
        np.array([row.theta1_deg for row in rows], dtype=np.float64),
        np.array([row.theta2_deg for row in rows], dtype=np.float64),
        np.array([row.direction1 for row in rows], dtype=np.float64),
        np.array([row.direction2 for row in rows], dtype=np.float64),
        np.array([row.displacement_mm for row in rows], dtype=np.float64),
        np.array([row.sigma_mm for row in rows], dtype=np.float64) if with_sigma else None,
    )
