"""What an arm misses each pose by as a whole: it repeats to some hundredths, and its errors are not all in the model.

All targets of a pose share that. Where several were measured their rows are no independent witnesses, and parameters
are less certain than so many rows would make them.
"""

import numpy as np

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.tried_sizes import tried_sizes

_TRIED_MM = (0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.5, 1.0)
"""Standard deviations of a coordinate of a pose that are tried."""


_SIGNIFICANT_GAIN = 2.71
"""Gain of the logarithm of the likelihood that chance exceeds once in a hundred times: half of the 0.98 quantile of
χ² with one degree of freedom, since a size cannot be negative."""


def find_scatter(calibration: Calibration) -> float | None:
    """Return the likeliest standard deviation of a pose's coordinates, in the measure of the stated uncertainties.

    Returns:
        Times the scale of the calibration that knows it, it is in mm; None where none is seen beyond chance, or where
        no pose has several targets.
    """
    model, values = calibration.model, calibration.estimate.values
    unit = _of_unit_size(model)
    if not model.stated or not unit.shape[1]:
        return None
    sizes = tried_sizes(calibration, _TRIED_MM)
    likelihoods = restricted_log_likelihoods(
        whitening_at(model, values),
        model.jacobian(values),
        calibration.estimate.residuals_mm,
        unit,
        sizes,
    )
    best = int(np.argmax(likelihoods))
    return sizes[best] if likelihoods[best] - likelihoods[0] > _SIGNIFICANT_GAIN else None


def scatter_errors(model: ArmModel, size: float) -> Shared:
    """Return what the rows of each pose share."""
    return Shared("scatter of the poses", size * _of_unit_size(model))


def _of_unit_size(model: ArmModel) -> Floats:
    """Return what a scatter of 1 mm does to the rows, a column a pose and coordinate, shape (rows, 3 poses)."""
    points, axes = model.measurements.points, model.axes[1]
    numbers, counts = np.unique(points.pose, return_counts=True)
    several = numbers[counts > 1]
    effects = np.zeros((model.rows, 3 * len(several)))
    for column, pose in enumerate(several):
        for row in np.flatnonzero(points.pose == pose):
            effects[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] = axes[row]
    return effects
