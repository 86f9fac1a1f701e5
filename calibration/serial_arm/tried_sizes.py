"""Sizes of a shared error that a restricted likelihood tries, in proportion to the errors of the rows.

The likelihood takes the scale of all errors from the rows. Sizes are tried as so many mm of what the rows show, and
those of wrongly stated uncertainties find the same: a size is in the measure of the stated ones, and times
`Calibration.scale` it is in mm.
"""

from collections.abc import Sequence

import numpy as np

from catseye.calibration.serial_arm.identification import Calibration

_MOST_BY_WHITE = 1e3
"""A shared error so many times the most certain row's own hides that one: sums of products lose digits."""


def tried_sizes(calibration: Calibration, tried_mm: Sequence[float]) -> tuple[float, ...]:
    """Return none, then what sizes in mm are in the measure of the stated uncertainties."""
    model = calibration.model
    most = _MOST_BY_WHITE / float(model.weights[: model.measured_rows].max())
    return (0.0, *np.minimum(np.array(tried_mm) / calibration.scale, most).tolist())
