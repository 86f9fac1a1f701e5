"""Tables that a calibrated arm cannot have given: refused before figures are made of them."""

from dataclasses import replace

import numpy as np

from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.app.results.serial_arm.length_errors import LengthErrors
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.misfit import fits
from catseye.calibration.serial_arm.plausibility import ImplausibleError, require_of_arm

_OTHER_ZERO_MM = 1.0
"""No dead path is wrong by more, nor does an arm miss all distances by the same."""

_FAR_BETTER = 0.2
"""Share of the errors that is left when another dead path explains them."""

_FEWEST = 3
"""Distances of a segment that show that they all miss by the same."""


def require_table_of_arm(arm: IdentifiedArm, rows: Measurements) -> None:
    """Refuse measurements that the arm does not fit, wherever its base stands.

    Raises:
        ImplausibleError: names the likely mistake.
    """
    # Two known anchors do not say how the base is turned: those of distances stand where they leave the least.
    loose = tuple(replace(one, u_mm=None) for one in rows.distances.anchors)
    rows = replace(rows, distances=replace(rows.distances, anchors=loose))
    require_of_arm(_with_identified_targets(arm), rows)


def require_same_frame(arm: IdentifiedArm, missed_mm: Floats) -> None:
    """Refuse places that the arm misses where its base stands, though it fits them elsewhere.

    Args:
        missed_mm: predicted minus measured places, shape (n, 3).

    Raises:
        ImplausibleError: they are in another frame.
    """
    misfit = float(np.sqrt(np.mean(np.square(missed_mm))))
    if not fits(arm.arm, misfit):
        raise ImplausibleError(
            f"the calibrated arm misses the measured places by {misfit:.3g} mm rms, more than an arm may be wrong "
            "by: they are in another frame than those of the calibration. Measure both from one station or fixed "
            "nests, or transform the table into the frame of the calibration"
        )


def require_same_dead_paths(arm: IdentifiedArm, found: LengthErrors, rows: Measurements) -> None:
    """Refuse distances with a dead path of the result that all miss by the same: the counter was zeroed since.

    Raises:
        ImplausibleError: names the segment.
    """
    distances = rows.distances
    for number, name in enumerate(distances.segments):
        missed = found.missed_mm[distances.segment == number]
        if name not in arm.distances.dead_paths or len(missed) < _FEWEST:
            continue
        mean, scatter = float(missed.mean()), float(missed.std())
        if abs(mean) > max(_OTHER_ZERO_MM, scatter / _FAR_BETTER):
            raise ImplausibleError(
                f"{name}: all {len(missed)} distances are {abs(mean):.3g} mm {'shorter' if mean > 0 else 'longer'} "
                f"than predicted, and scatter by {scatter:.3g} mm about that: the counter has been zeroed since the "
                "calibration, whose segment of that name has another dead path. Give each start of the counter its "
                "own name in the column segment; a name that the result does not know is fitted"
            )


def _with_identified_targets(arm: IdentifiedArm) -> SerialArm:
    """Return the nominal arm with its targets where the result has them."""
    places = arm.geometry.tools[:, :3, 3].tolist()
    targets = [
        replace(target, place_mm=(x, y, z), u_mm=0.0)
        for target, (x, y, z) in zip(arm.arm.targets, places, strict=True)
    ]
    return arm.arm.with_targets(tuple(targets))
