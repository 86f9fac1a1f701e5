"""Stated uncertainties that are far too small: of some rows among others, or of all against what is left.

Rows that count a million times more than others bend the whole model to themselves; sound poses are then left out.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.measurements import Measurements

FAR_BELOW = 200.0
"""Times that a row may be more certain than most: more is another unit."""

DOUBTFUL = 10.0
"""Likewise: coordinates of one instrument differ by less, and from 20 on sound poses are left out for such rows."""

_FAR_BEYOND = 100.0
"""Times the stated uncertainties that rows may be missed by, where these are smaller than any instrument's."""

_LEAST_OF_PLACES_MM = 1e-3
_LEAST_OF_DISTANCES_MM = 1e-5
"""No instrument of this trade is more certain."""


@dataclass(frozen=True)
class _Kind:
    """Rows of one kind.

    Attributes:
        u: stated standard uncertainties, in the unit, shape (n,).
        pose: number of each row's pose, shape (n,).
        unit: of the uncertainties.
        mistaken: unit that smaller ones may be in.
        least: that is believed; nothing is too small for 0.
        residuals: where theirs stand among those of the model.
    """

    u: Floats
    pose: Ints
    unit: str
    mistaken: str
    least: float
    residuals: slice


def far_more_certain(rows: Measurements, times: float) -> str | None:
    """Return what is said of rows that are stated to be so many times more certain than most of their kind."""
    for kind in _kinds(rows):
        most = np.median(kind.u)
        few = kind.u < most / times
        if few.any():
            first = rows.names[kind.pose[int(np.argmax(few))]]
            return (
                f"the uncertainties of {np.count_nonzero(few)} rows (the first: pose {first!r}, "
                f"{kind.u[few][0]:.2g} {kind.unit}) are less than 1/{times:.0f} of those of most ({most:.2g} "
                f"{kind.unit}): such rows outweigh all others, and sound poses are left out for them. Are they in "
                f"{kind.mistaken}? Correct their u_{kind.unit}, or leave the rows out"
            )
    return None


def too_certain(found: Calibration) -> tuple[str, ...]:
    """Return a sentence where stated uncertainties are below any instrument's and rows are missed by far more."""
    texts = []
    for kind in _kinds(found.model.measurements):
        missed = np.sqrt(np.mean(np.square(found.estimate.residuals_mm[kind.residuals])))
        u = np.median(kind.u)
        if u < kind.least and missed > _FAR_BEYOND * u:
            texts.append(
                f"the stated uncertainties, {u:.2g} {kind.unit}, are smaller than those of any instrument, and rows "
                f"are missed by {missed:.2g} mm rms: they may be in {kind.mistaken}, not in {kind.unit}"
            )
    return tuple(texts)


def _kinds(rows: Measurements) -> Iterator[_Kind]:
    """Give the kinds of rows that state an uncertainty; of a place it is that of a coordinate, rms."""
    points, turned, distances = rows.points, rows.orientations, rows.distances
    places = 3 * len(points.pose)
    angles = places + 3 * len(turned.pose)
    if len(points.pose) and points.covariance_mm2 is not None:
        u = np.sqrt(np.trace(points.covariance_mm2, axis1=1, axis2=2) / 3.0)
        yield _Kind(u, points.pose, "mm", "m", _LEAST_OF_PLACES_MM, slice(places))
    if len(turned.pose) and turned.u_deg is not None:
        yield _Kind(turned.u_deg, turned.pose, "deg", "rad", 0.0, slice(places, angles))
    if len(distances.pose) and distances.u_mm is not None:
        stop = angles + len(distances.pose)
        yield _Kind(distances.u_mm, distances.pose, "mm", "m", _LEAST_OF_DISTANCES_MM, slice(angles, stop))
