"""Observability indices of a choice of poses, from the singular values of its Jacobian in scaled columns.

O1: Borm and Menq 1991; O2: Driels and Pathre 1990; O3, O4: Nahvi and Hollerbach 1994, 1996; O5: Sun and Hollerbach
2008. Larger is better with each.
"""

from typing import Literal, get_args

import numpy as np

from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.types import Floats

Index = Literal["O1", "O2", "O3", "O4", "O5"]

INDICES: tuple[Index, ...] = get_args(Index)

_NONE = 1e-14
"""Eigenvalues of the information below this share of the largest are rounding."""


def observability(information: Floats, poses: int, index: Index) -> Floats:
    """Return an index from sums of products of Jacobians.

    Args:
        information: JᵀJ in scaled columns, shape (..., m, m).
        poses: how many poses it comes from; O1 is per pose.

    Returns:
        Shape (...).

    Raises:
        ArgumentError: there is no such index.
    """
    require_one_of(Index, index, "index")
    values = np.linalg.eigvalsh(information)
    sigma = np.sqrt(np.maximum(values, _NONE * values[..., -1:]))
    least, largest, count = sigma[..., 0], sigma[..., -1], sigma.shape[-1]
    match index:
        case "O1":
            found = np.exp(np.log(sigma).sum(axis=-1) / count) / np.sqrt(poses)
        case "O2":
            found = least / largest
        case "O3":
            found = least
        case "O4":
            found = least**2 / largest
        case _:
            found = 1.0 / np.sum(1.0 / sigma, axis=-1)
    return np.asarray(found)
