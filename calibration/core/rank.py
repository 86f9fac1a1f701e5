"""Which combinations of parameters the points leave undetermined, by name."""

import numpy as np

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.least_squares import RANK_TOLERANCE, factorise
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.layout import Layout

_PARTICIPATION = 0.02
"""A parameter takes part in a null direction when its scaled share exceeds this."""


def null_directions(
    layout: Layout, jacobian: Floats, basis: Floats, tolerance: float = RANK_TOLERANCE
) -> list[list[str]]:
    """Return the undetermined combinations beyond the gauge, each as the names of its parameters.

    Args:
        layout: names of the parameters.
        jacobian: weighted Jacobian at the solution, shape (n, p).
        basis: steps that keep the gauge, shape (p, free).
        tolerance: singular values below this share of the largest count as zero.
    """
    names = layout.names()
    norms = np.linalg.norm(jacobian, axis=0)
    touched = norms > 0.0
    untouched = [[names[i]] for i in np.flatnonzero(~touched)]
    if not touched.all():
        basis = _basis_within(basis, touched)
    factor = factorise(jacobian @ basis)
    null = factor.right[factor.singular_values <= tolerance * factor.singular_values[0]]
    return untouched + [_involved(names, norms, basis @ (row / factor.scale)) for row in null]


def require_identifiable(
    layout: Layout, jacobian: Floats, basis: Floats, tolerance: float = RANK_TOLERANCE
) -> None:
    """Refuse a problem that leaves parameters undetermined; arguments are those of null_directions.

    Raises:
        UnidentifiableError: names the parameters of each null direction and what to measure.
    """
    directions = null_directions(layout, jacobian, basis, tolerance)
    if not directions:
        return
    own = {term.name for term in layout.terms if term.of_own_joint}
    periodic = [
        name for name in layout.names() if any(name in own.intersection(names) for names in directions)
    ]
    rest = [names for names in directions if not own.intersection(names)]
    single = [names[0] for names in rest if len(names) == 1]
    mixed = [", ".join(names) for names in rest if len(names) > 1]
    parts = []
    if periodic:
        parts.append(
            f"at these commands the maps absorb {_shortened(periodic)}: measure between the nodes, at angles that "
            "differ within the period, or leave the terms out"
        )
    if single:
        parts.append(
            f"no point touches {_shortened(single)}: approach these nodes from these directions, "
            "or leave the nodes out of the cell file's [measurement]"
        )
    parts += [
        f"the points cannot separate {text}: vary the commands of both joints more, or add a reflector"
        for text in mixed
    ]
    raise UnidentifiableError("the points do not determine every parameter: " + "; ".join(parts), directions)


def _basis_within(basis: Floats, touched: Bools) -> Floats:
    """Return a basis of the gauge-keeping steps that leave untouched parameters alone."""
    _, values, right = np.linalg.svd(basis[~touched], full_matrices=True)
    rank = int(np.sum(values > 1e-12))
    return np.asarray(basis @ right[rank:].T, dtype=np.float64)


def _involved(names: list[str], norms: Floats, direction: Floats) -> list[str]:
    share = np.abs(direction * np.where(norms > 0.0, norms, 1.0))
    return [names[i] for i in np.flatnonzero(share > _PARTICIPATION * share.max())]


def _shortened(names: list[str], most: int = 12) -> str:
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
