"""Stated uncertainties that are far too small: of some rows among others, or of all against what is left.

Rows that count a million times more than others bend the whole model to themselves; sound poses are then left out.
"""

from collections.abc import Iterator

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


def far_more_certain(rows: Measurements, times: float) -> str | None:
    """Return what is said of rows that are stated to be so many times more certain than most of their kind."""
    for u_mm, pose, _ in _kinds(rows):
        most = np.median(u_mm)
        few = u_mm < most / times
        if few.any():
            first = rows.names[pose[int(np.argmax(few))]]
            return (
                f"the uncertainties of {np.count_nonzero(few)} rows (the first: pose {first!r}, "
                f"{u_mm[few][0]:.2g} mm) are less than 1/{times:.0f} of those of most ({most:.2g} mm): such rows "
                "outweigh all others, and sound poses are left out for them. Are they in m? Correct their u_mm, or "
                "leave the rows out"
            )
    return None


def too_certain(found: Calibration) -> tuple[str, ...]:
    """Return a sentence where stated uncertainties are below any instrument's and rows are missed by far more."""
    rows, residuals = found.model.measurements, found.estimate.residuals_mm
    texts = []
    for (u_mm, _, least_mm), missed_mm in zip(_kinds(rows), _missed(rows, residuals), strict=True):
        u, missed = float(np.median(u_mm)), float(np.sqrt(np.mean(np.square(missed_mm))))
        if u < least_mm and missed > _FAR_BEYOND * u:
            texts.append(
                f"the stated uncertainties, {u:.2g} mm, are smaller than those of any instrument, and rows are "
                f"missed by {missed:.2g} mm rms: they may be in m, not in mm"
            )
    return tuple(texts)


def _kinds(rows: Measurements) -> Iterator[tuple[Floats, Ints, float]]:
    """Give standard uncertainties, poses, and the least that is believed, of places and of distances."""
    points, distances = rows.points, rows.distances
    if len(points.pose) and points.covariance_mm2 is not None:
        yield (
            np.sqrt(np.trace(points.covariance_mm2, axis1=1, axis2=2) / 3.0),
            points.pose,
            _LEAST_OF_PLACES_MM,
        )
    if len(distances.pose) and distances.u_mm is not None:
        yield distances.u_mm, distances.pose, _LEAST_OF_DISTANCES_MM


def _missed(rows: Measurements, residuals_mm: Floats) -> Iterator[Floats]:
    """Give the residuals of the same kinds."""
    places = 3 * len(rows.points.pose)
    first = places + 3 * len(rows.orientations.pose)
    if places and rows.points.covariance_mm2 is not None:
        yield residuals_mm[:places]
    if len(rows.distances.pose) and rows.distances.u_mm is not None:
        yield residuals_mm[first : first + len(rows.distances.pose)]
