"""Rows of the Jacobian of a block of distances, without the zeros."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.arm import LOCAL
from catseye.calibration.scara.distance_model import DistanceModel


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
    """Residuals of a block and their derivatives.

    Attributes:
        residuals: predicted minus measured, mm, shape (n,).
        slots: what each row of the Jacobian holds: 2 links, 4 nodes, 2 of the reflector, 1 dead path, further terms.
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


def sparse_rows(model: DistanceModel, parameters: Floats, weights: Floats) -> SparseRows:
    """Return a block's residuals and weighted derivatives.

    Args:
        model: the block's points and commands.
        parameters: where, shape (p,).
        weights: what each row is multiplied with, shape (n,); the residuals are not.
    """
    layout, design, points = model.layout, model.design, model.points
    length, unit = model.beam(parameters)
    residuals = length + design.added("length", parameters)
    residuals -= parameters[layout.dead_path][points.dead_path] + points.displacement_mm
    unit = unit * weights[:, None]
    local = np.einsum("ni,nij->nj", unit, design.local_jacobian(parameters))
    whole = np.zeros(len(points), dtype=np.int64)
    slots = [Slot(0, 1, whole, local[:, 0]), Slot(1, 1, whole, local[:, 1])]
    for k in range(4):
        table = layout.map1 if k < 2 else layout.map2
        if table.stop > table.start:
            column, value = design.columns[:, k] - table.start, design.weights[:, k] * local[:, 2 + k // 2]
            slots.append(Slot(table.start, table.stop - table.start, column, value))
    for i, term in enumerate(layout.terms):
        answer = local[:, LOCAL[term.target]] if term.target in LOCAL else weights
        slots.append(Slot(layout.extension.start + i, 1, whole, design.extra[:, i] * answer))
    places = 2 * len(layout.reflector_names)
    for axis in range(2):
        slots.append(Slot(layout.reflectors.start, places, 2 * points.reflector + axis, -unit[:, axis]))
    slots.append(Slot(layout.dead_path.start, len(layout.dead_paths), points.dead_path, -weights))
    return SparseRows(residuals, tuple(slots), layout.size)
