"""What errors of distances are expected to be: from parameters, ends, instrument, and what the model misses."""

from collections.abc import Callable, Mapping

import numpy as np

from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.app.results.serial_arm.length_errors import LengthErrors, left_variance_mm2, root_of
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.arm import Anchor
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.measurements import Measurements


def length_variance_mm2(
    arm: IdentifiedArm, moved: Floats, found: LengthErrors, rows: Measurements, stated: Mapping[str, Anchor]
) -> Floats:
    """Return the variances of the errors of distances, mm², shape (n,).

    Args:
        moved: how the identified parameters of the arm move the targets, shape (n, 3, p).
        stated: anchors that are not those of the result, by name.
    """
    distances, names = rows.distances, [one.name for one in rows.distances.anchors]
    own = [
        arm.distances.moved(
            "" if names[anchor] in stated else names[anchor],
            "" if segment < 0 else distances.segments[segment],
            towards,
        )
        for anchor, segment, towards in zip(
            distances.anchor.tolist(), distances.segment.tolist(), found.towards, strict=True
        )
    ]
    slopes = np.column_stack([np.einsum("ni,nip->np", found.towards, moved), np.array(own)])
    shared = [slopes @ root_of(arm.with_distances)]
    shared += [
        u_mm * found.towards * (distances.anchor == number)[:, None]
        for number, name in enumerate(names)
        if name in stated and (u_mm := stated[name].u_mm)
    ]
    single = np.full(len(distances.pose), arm.left_mm**2)
    if distances.u_mm is not None:
        single = single + distances.u_mm**2
    return left_variance_mm2(found.fitted, np.column_stack(shared), single)


def targets_of_distances(
    rows: Measurements, places: Callable[[Commands, int], tuple[Floats, Floats]]
) -> tuple[Floats, Floats]:
    """Return targets at the rows of distances, mm, shape (n, 3), and how parameters move them, shape (n, 3, p)."""
    distances = rows.distances
    found: list[tuple[Ints, Floats, Floats]] = []
    for number in np.unique(distances.target).tolist():
        of_it = np.flatnonzero(distances.target == number)
        found.append((of_it, *places(rows.commands.some(distances.pose[of_it]), number)))
    order = np.argsort(np.concatenate([of_it for of_it, _, _ in found]))
    return (
        np.concatenate([place for _, place, _ in found])[order],
        np.concatenate([moved for _, _, moved in found])[order],
    )
