"""How well sizes of a shared error explain the rows: restricted likelihood (Patterson and Thompson 1971)."""

from collections.abc import Sequence

import numpy as np
from scipy import linalg

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening, through_sources

_ALIKE = 1e3
"""Uncertainties that differ by no more than such a factor hide nothing from one another."""


def restricted_log_likelihoods(
    whitening: Whitening, jacobian: Floats, residuals_mm: Floats, effects_mm: Floats, sizes: Sequence[float]
) -> Floats:
    """Return the logarithms of the restricted likelihoods of sizes of a further shared error, up to a constant.

    The scale of all errors together is taken from the rows: only what the shared error is in proportion to the others
    counts. Everything follows from sums of products, which are taken once.

    Args:
        whitening: of the rows without that error.
        jacobian: derivatives of the residuals on free directions, of full rank, shape (n, free).
        residuals_mm: anywhere near the estimate, shape (n,).
        effects_mm: of sources of unit variance at size 1, shape (n, m).

    Returns:
        One for each size, shape (sizes,).

    Raises:
        CalibrationError: weights of the rows are too different, or too large, to be added up.
    """
    rows, free = jacobian.shape
    scale = np.linalg.norm(jacobian * whitening.weights[:, None], axis=0)
    columns = whitening.rows(np.column_stack([jacobian / scale, residuals_mm, effects_mm]))
    products = columns.T @ columns
    crossed, sources = products[: free + 1, free + 1 :], products[free + 1 :, free + 1 :]

    def likelihood(size: float) -> float:
        left = through_sources(products[: free + 1, : free + 1], size * crossed, size**2 * sources)
        try:
            triangle = linalg.cholesky(left, lower=True, check_finite=False)
        except linalg.LinAlgError:
            raise CalibrationError(_too_small(whitening.weights)) from None
        rest = triangle[free, free] ** 2
        shared = np.linalg.slogdet(np.eye(len(sources)) + size**2 * sources)[1]
        determined = 2.0 * np.sum(np.log(np.diag(triangle)[:free]))
        return float(-0.5 * ((rows - free) * np.log(rest) + shared + determined))

    return np.array([likelihood(size) for size in sizes])


def _too_small(weights: Floats) -> str:
    """Return why products of rows cannot be added up: some of them hide the others, or all hide what is shared."""
    if weights.max() > _ALIKE * weights.min():
        return (
            "the uncertainties of the rows differ by so many orders of magnitude that the small ones hide all "
            "others: state all of them in mm, and look for rows whose uncertainty has another unit"
        )
    return (
        f"the uncertainties of the rows, {1.0 / np.median(weights):.2g} mm, are so many orders of magnitude below "
        "what rows may be off together that nothing else counts: state them in mm as the instrument has them, or "
        "leave them out"
    )
