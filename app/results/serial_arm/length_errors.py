"""Errors of distances: what is known of their ends, what has to be fitted, and what is left to be expected then."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.serial_arm.closed_form import refined_anchor
from catseye.calibration.serial_arm.measurements import Measurements

_FEWEST = 2
"""Distances of a dead path that nobody knows: one alone would always agree."""


@dataclass(frozen=True)
class LengthErrors:
    """Errors of the distances of one state of the arm.

    Attributes:
        missed_mm: predicted minus measured, shape (n,).
        towards: unit vectors from the anchors to the targets, shape (n, 3).
        fitted: how the distances change with what was fitted to them, shape (n, k).
        dead_paths: names of those that were fitted at known anchors.
    """

    missed_mm: Floats
    towards: Floats
    fitted: Floats
    dead_paths: tuple[str, ...]


def length_errors(
    anchors: Mapping[str, Floats], dead_paths: Mapping[str, float], targets_mm: Floats, rows: Measurements
) -> LengthErrors:
    """Return the errors of distances; an anchor or a dead path that is not known is where it leaves the least.

    Args:
        anchors: places of the known ones, mm.
        dead_paths: known ones, mm, by anchor and segment.
        targets_mm: predicted, at every distance, shape (n, 3).

    Raises:
        InsufficientPointsError: too few distances to find what is not known.
    """
    distances = rows.distances
    count = len(distances.pose)
    missed, towards = np.zeros(count), np.zeros((count, 3))
    fitted, names = [np.zeros((count, 0))], []
    for number in np.unique(distances.anchor).tolist():
        of_it = distances.anchor == number
        place = anchors.get(distances.anchors[number].name)
        segments = [k for k in np.unique(distances.segment[of_it]).tolist() if k >= 0]
        own = {-1: 0.0} | {
            k: dead_paths[name]
            for k in segments
            if (name := distances.segments[k]) in dead_paths and place is not None
        }
        lacking = [k for k in segments if k not in own]
        if place is None:
            place, paths = refined_anchor(targets_mm, rows, number)
            own |= paths
        beam = targets_mm[of_it] - place
        length = np.linalg.norm(beam, axis=1)
        towards[of_it] = beam / length[:, None]
        if distances.anchors[number].name in anchors:
            own |= _dead_paths(lacking, length - distances.distance_mm[of_it], rows, of_it)
            names += [distances.segments[k] for k in lacking]
        else:
            fitted.append(-towards * of_it[:, None])
        fitted += [-1.0 * (distances.segment == k)[:, None] for k in lacking]
        dead = np.array([own[k] for k in distances.segment[of_it].tolist()])
        missed[of_it] = length - dead - distances.distance_mm[of_it]
    return LengthErrors(missed, towards, np.column_stack(fitted), tuple(names))


def _dead_paths(
    lacking: list[int], longer_mm: Floats, rows: Measurements, of_anchor: Bools
) -> dict[int, float]:
    """Return the dead paths of segments at a known anchor: by how much the distances are longer on the average.

    Raises:
        InsufficientPointsError: a single distance has such a dead path.
    """
    segment, found = rows.distances.segment[of_anchor], {}
    for k in lacking:
        of_it = segment == k
        if np.count_nonzero(of_it) < _FEWEST:
            raise InsufficientPointsError(
                f"{rows.distances.segments[k]}: a single distance does not say what its dead path is: measure at "
                f"least {_FEWEST}, or leave the row out"
            )
        found[k] = float(longer_mm[of_it].mean())
    return found


def left_variance_mm2(fitted: Floats, shared: Floats, own_mm2: Floats) -> Floats:
    """Return the variances of errors that are left when something was fitted to them by least squares, shape (n,).

    Args:
        fitted: how the errors change with it, shape (n, k).
        shared: how they change with independent errors of unit variance that rows have in common, mm, shape (n, m).
        own_mm2: variances of the errors that each row has to itself, shape (n,).
    """
    taken = np.linalg.qr(fitted)[0] if fitted.shape[1] else fitted
    left = shared - taken @ (taken.T @ shared)
    among = taken.T @ (own_mm2[:, None] * taken)
    own = own_mm2 * (1.0 - 2.0 * np.sum(taken**2, axis=1)) + np.einsum("nk,kl,nl->n", taken, among, taken)
    return np.asarray(np.maximum(np.sum(left**2, axis=1) + own, 0.0))


def root_of(covariance: Floats) -> Floats:
    """Return R with R Rᵀ a covariance that may be singular, shape (p, p)."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
