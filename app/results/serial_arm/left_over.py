"""By how much a model misses single poses beyond what is known of parameters and rows.

A model that lacks something of the arm, or an arm that does not repeat, misses every pose by an error of its own,
which no number of poses makes smaller. The poses that were left out show it.
"""

import numpy as np

from catseye.app.results.serial_arm.identified_arm import IdentifiedArm, identified_arm
from catseye.app.results.serial_arm.length_errors import length_errors
from catseye.app.results.serial_arm.length_variance import length_variance_mm2, targets_of_distances
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.choice import Chosen
from catseye.calibration.serial_arm.measurements import Measurements


def missed_beyond_mm(result: SerialArmResult, found: Chosen) -> float | None:
    """Return the standard deviation of each coordinate; None where nothing shows that single poses are missed.

    Args:
        result: of the identification, with its loss, before anything is known to be left.
    """
    rows = found.calibration.model.measurements
    if not (rows.stated and _suspected(result)):
        return None
    arm = identified_arm(result)
    known = np.concatenate([_of_points_mm2(arm, rows), _of_distances_mm2(arm, rows)])
    coordinates = np.concatenate([np.full(len(rows.points.pose), 3), np.ones(len(rows.distances.pose))])
    beyond = found.held_out.error_mm**2 - known
    counted = np.isfinite(beyond) & ~np.isin(found.held_out.pose, found.contradicting)
    if not counted.any():
        return None
    return float(np.sqrt(max(np.sum(beyond[counted]), 0.0) / np.sum(coordinates[counted])))


def _suspected(result: SerialArmResult) -> bool:
    """Return whether more is missed than parameters and rows explain; a robust loss tests nothing itself."""
    return result.fit.lack_of_fit or result.pose_scatter_mm is not None or result.loss != "squares"


def _of_points_mm2(arm: IdentifiedArm, rows: Measurements) -> Floats:
    """Return what is known of the squares of three-dimensional errors, shape (points,)."""
    points = rows.points
    covariance = np.zeros((0, 3, 3)) if points.covariance_mm2 is None else points.covariance_mm2
    known = np.trace(covariance, axis1=1, axis2=2)
    for number in np.unique(points.target).tolist():
        of_it = np.flatnonzero(points.target == number)
        _, of_place = arm.places_mm(rows.commands.some(points.pose[of_it]), number)
        known[of_it] += np.trace(of_place, axis1=1, axis2=2)
    return np.asarray(known)


def _of_distances_mm2(arm: IdentifiedArm, rows: Measurements) -> Floats:
    """Return the same of distances, shape (distances,)."""
    if not len(rows.distances.pose):
        return np.zeros(0)
    places, moved = targets_of_distances(rows, arm.moved_mm)
    ends = arm.distances
    return length_variance_mm2(
        arm, moved, length_errors(ends.anchors, ends.dead_paths, places, rows), rows, {}
    )
