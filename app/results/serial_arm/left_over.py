"""By how much a model misses single poses beyond what is known of parameters and rows.

A model that lacks something of the arm, or an arm that does not repeat, misses every pose by an error of its own,
which no number of poses makes smaller. The poses that were left out show it.
"""

import numpy as np

from catseye.app.results.serial_arm.identified_arm import identified_arm
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.serial_arm.choice import Chosen


def missed_beyond_mm(result: SerialArmResult, found: Chosen) -> float | None:
    """Return the standard deviation of each coordinate; None where the rows do not contradict what is stated.

    Args:
        result: of the identification, before anything is known to be left.
    """
    measurements = found.calibration.model.measurements
    points = measurements.points
    if not result.fit.lack_of_fit or points.covariance_mm2 is None:
        return None
    arm = identified_arm(result)
    known = np.trace(points.covariance_mm2, axis1=1, axis2=2)
    for number in np.unique(points.target).tolist():
        of_it = np.flatnonzero(points.target == number)
        _, covariance = arm.places_mm(measurements.commands.some(points.pose[of_it]), number)
        known[of_it] += np.trace(covariance, axis1=1, axis2=2)
    beyond = found.held_out.error_mm[: len(points.pose)] ** 2 - known
    if not np.isfinite(beyond).any():
        return None
    return float(np.sqrt(max(np.nanmean(beyond), 0.0) / 3.0))
