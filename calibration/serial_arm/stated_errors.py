"""Stated uncertainties that are far too small: of some rows among others, or of all against what is left.

Rows that count a million times more than others bend the whole model to themselves; sound poses are then left out.
Instruments differ by as much, though, and arms miss more than fine instruments do: what is small is refused where it
would be usual in another unit, or where no instrument is so certain.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
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
"""Few instruments of this trade are more certain."""

_NONE_SHARE = 0.1
"""Of these least uncertainties: below that none is."""

_ALIKE = 3.0
"""Uncertainties of one campaign, and what is left against what is stated, agree within such a factor."""


@dataclass(frozen=True)
class _Kind:
    """Rows of one kind.

    Attributes:
        u: stated standard uncertainties, in the unit, shape (n,).
        pose: number of each row's pose, shape (n,).
        unit: of the uncertainties.
        mistaken: unit that smaller ones may be in.
        factor: how much larger they are then.
        least: that is believed; nothing is too small for 0.
        residuals: where theirs stand among those of the model.
    """

    u: Floats
    pose: Ints
    unit: str
    mistaken: str
    factor: float
    least: float
    residuals: slice

    def doubtful(self, u: float, reference: float) -> bool:
        """Return whether an uncertainty would be a usual one in the other unit, or is one of no instrument."""
        in_other_unit = 1.0 / _ALIKE < self.factor * u / reference < _ALIKE
        return in_other_unit or u < _NONE_SHARE * self.least


def in_other_unit(rows: Measurements) -> str | None:
    """Return what is said of rows that are far more certain than most, as they would be in another unit."""
    for kind in _kinds(rows):
        most = float(np.median(kind.u))
        few = kind.u < most / FAR_BELOW
        if few.any() and kind.doubtful(float(np.median(kind.u[few])), most):
            return (
                f"{_more_certain(rows, kind, few, FAR_BELOW)}, and sound poses are left out for them. Are they in "
                f"{kind.mistaken}? Correct their u_{kind.unit}, or leave the rows out"
            )
    return None


def far_more_certain(rows: Measurements) -> str | None:
    """Return what is remarked of rows that are stated to be more certain than most of their kind."""
    for kind in _kinds(rows):
        few = kind.u < np.median(kind.u) / DOUBTFUL
        if few.any():
            return (
                f"{_more_certain(rows, kind, few, DOUBTFUL)}. Are they in {kind.mistaken}? Correct their "
                f"u_{kind.unit} then, or leave the rows out: sound poses may be left out for them"
            )
    return None


def _more_certain(rows: Measurements, kind: _Kind, few: Bools, times: float) -> str:
    first = rows.names[kind.pose[int(np.argmax(few))]]
    return (
        f"the uncertainties of {np.count_nonzero(few)} rows (the first: pose {first!r}, "
        f"{kind.u[few][0]:.2g} {kind.unit}) are less than 1/{times:.0f} of those of most ({np.median(kind.u):.2g} "
        f"{kind.unit}): such rows outweigh all others"
    )


def too_certain(found: Calibration) -> tuple[str, ...]:
    """Return a sentence where stated uncertainties are below any instrument's and rows are missed by far more."""
    texts = []
    for kind in _kinds(found.model.measurements):
        missed = float(np.sqrt(np.mean(np.square(found.estimate.residuals_mm[kind.residuals]))))
        u = float(np.median(kind.u))
        if u < kind.least and missed > _FAR_BEYOND * u and kind.doubtful(u, missed):
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
        yield _Kind(u, points.pose, "mm", "m", 1000.0, _LEAST_OF_PLACES_MM, slice(places))
    if len(turned.pose) and turned.u_deg is not None:
        yield _Kind(turned.u_deg, turned.pose, "deg", "rad", np.rad2deg(1.0), 0.0, slice(places, angles))
    if len(distances.pose) and distances.u_mm is not None:
        stop = angles + len(distances.pose)
        yield _Kind(
            distances.u_mm, distances.pose, "mm", "m", 1000.0, _LEAST_OF_DISTANCES_MM, slice(angles, stop)
        )
