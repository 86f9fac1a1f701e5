"""How well sizes of shared errors explain rows: restricted likelihood (Patterson and Thompson 1971)."""

import numpy as np
from scipy import linalg

from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening


def restricted_log_likelihood(whitening: Whitening, jacobian: Floats, residuals_mm: Floats) -> float:
    """Return the logarithm of the restricted likelihood, up to what all whitenings with the same weights share.

    The scale of all errors together is taken from the rows: only what shared errors are in proportion to the others
    counts.

    Args:
        jacobian: derivatives of the residuals on free directions, of full rank, shape (n, free).
        residuals_mm: anywhere near the estimate, shape (n,).
    """
    rows, free = jacobian.shape
    triangle = linalg.qr(
        np.column_stack([whitening.rows(jacobian), whitening.rows(residuals_mm)]),
        mode="r",
        check_finite=False,
    )[0]
    rest = float(triangle[free, free] ** 2)
    sources = whitening.effects.shape[1]
    own = np.linalg.slogdet(np.eye(sources) + whitening.effects.T @ whitening.effects)[1]
    determined = 2.0 * np.sum(np.log(np.abs(np.diag(triangle)[:free])))
    return float(-0.5 * ((rows - free) * np.log(rest / (rows - free)) + own + determined))
