"""Rows of the Jacobian of a block of distances, without the zeros."""

import numpy as np

from catseye.calibration.core.blockwise.sparse_rows import Slot, SparseRows
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import LOCAL
from catseye.calibration.scara.distance_model import DistanceModel


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
