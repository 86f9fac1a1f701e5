"""Covariance from a normal matrix: what squaring leaves of rank and digits."""

import numpy as np
from scipy import linalg

from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.types import Floats

SQUARED_RANK_TOLERANCE = 3e-6
"""Singular values below this share of the largest count as zero here.

The normal matrix holds their squares, 1e-11 of its largest eigenvalue: a hundred times what rounding of its sums
leaves. A Jacobian itself separates directions down to 1e-10; what lies between is refused here although the
rows themselves could solve it, for the squares of such values carry too few digits for an uncertainty."""


def white_covariance(matrix: Floats, parameters: Parameters) -> Floats:
    """Return the covariance for unit weights, shape (p, p).

    Args:
        matrix: normal matrix JᵀWJ, shape (p, p).
        parameters: names and gauge.

    Raises:
        UnidentifiableError: directions that the normal matrix does not separate from null directions.
    """
    root = _square_root(matrix)
    factor = factorise(root @ parameters.basis)
    if factor.singular_values[-1] <= SQUARED_RANK_TOLERANCE * factor.singular_values[0]:
        require_identifiable(parameters, root, SQUARED_RANK_TOLERANCE)
    return factor.covariance_on(parameters.basis)


def _square_root(matrix: Floats) -> Floats:
    """Return R with RᵀR = matrix, shape (p, p): it stands for the Jacobian; a column of zeros stays one."""
    norms = np.sqrt(np.diag(matrix))
    scale = np.where(norms > 0.0, norms, 1.0)
    values, vectors = linalg.eigh(matrix / np.outer(scale, scale))
    return np.asarray((np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T) * norms, dtype=np.float64)
