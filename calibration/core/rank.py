"""Which combinations of parameters the rows leave undetermined, by name."""

import numpy as np
from scipy import linalg

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.least_squares import RANK_TOLERANCE, factorise
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.types import Bools, Floats

_PARTICIPATION = 0.02
"""A parameter takes part in a null direction when its scaled share exceeds this."""

_RANK = 1e-12
"""Eigenvalues of scaled information below this share of the largest count as zero."""

_INVOLVED = 1e-4
"""A parameter is loose when its scaled share in a null direction of information exceeds this."""


def null_directions(
    parameters: Parameters, jacobian: Floats, tolerance: float = RANK_TOLERANCE
) -> list[list[str]]:
    """Return the undetermined combinations beyond the gauge, each as the names of its parameters.

    Args:
        jacobian: weighted Jacobian at the solution, shape (n, p).
        tolerance: singular values below this share of the largest count as zero.
    """
    names, basis = parameters.names, parameters.basis
    norms = np.linalg.norm(jacobian, axis=0)
    touched = norms > 0.0
    untouched = [[names[i]] for i in np.flatnonzero(~touched)]
    if not touched.all():
        basis = _basis_within(basis, touched)
    factor = factorise(jacobian @ basis)
    null = factor.right[factor.singular_values <= tolerance * factor.singular_values[0]]
    return untouched + [_involved(names, norms, basis @ (row / factor.scale)) for row in null]


def require_identifiable(parameters: Parameters, jacobian: Floats, tolerance: float = RANK_TOLERANCE) -> None:
    """Refuse a problem that leaves parameters undetermined; arguments are those of `null_directions`.

    Raises:
        UnidentifiableError: names the parameters of each null direction and what to measure.
    """
    directions = null_directions(parameters, jacobian, tolerance)
    if directions:
        raise UnidentifiableError(parameters.undetermined(directions), directions)


def known_variances(information: Floats, basis: Floats) -> tuple[Floats, Bools]:
    """Return the variances of parameters in the gauge and flags of those that are not determined, shape (p,) each.

    Args:
        information: of the parameters, JᵀV⁻¹J, shape (p, p).
        basis: steps that keep the gauge, shape (p, free).
    """
    reduced = basis.T @ information @ basis
    diagonal = np.diag(reduced)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    values, vectors = linalg.eigh(reduced * np.outer(scale, scale), check_finite=False)
    regular = values > _RANK * values[-1]
    directions = basis @ (scale[:, None] * vectors)
    half = directions[:, regular] / np.sqrt(values[regular])
    variance = np.sum(half**2, axis=1)
    norms = np.sqrt(np.diag(information))
    touched = norms > 0.0
    share = np.abs(directions[:, ~regular]) * np.where(touched, norms, norms.max())[:, None]
    loose = ~touched | np.any(share > _INVOLVED * share.max(axis=0, initial=0.0), axis=1)
    return variance, np.asarray(loose)


def _basis_within(basis: Floats, touched: Bools) -> Floats:
    """Return a basis of the gauge-keeping steps that leave untouched parameters alone."""
    _, values, right = np.linalg.svd(basis[~touched], full_matrices=True)
    rank = int(np.sum(values > 1e-12))
    return np.asarray(basis @ right[rank:].T, dtype=np.float64)


def _involved(names: tuple[str, ...], norms: Floats, direction: Floats) -> list[str]:
    share = np.abs(direction * np.where(norms > 0.0, norms, 1.0))
    return [names[i] for i in np.flatnonzero(share > _PARTICIPATION * share.max())]
