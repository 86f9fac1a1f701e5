"""Parameters as result files have them: absolute values, the base as its place and angles in the instrument's frame.

Inside, the base is counted from where a closed form put it; angles there are small, and nothing is singular.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import angles_of
from catseye.calibration.serial_arm.geometry import Geometry, turning_axis
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.parameters import FRAME_PARTS, BaseFrame


@dataclass(frozen=True)
class Absolute:
    """Estimated parameters in absolute values.

    Attributes:
        names: of the estimated parameters.
        values: shape (p,).
        covariance: shape (p, p).
        rates: how the absolute values change with those that are estimated, shape (p, p).
    """

    names: tuple[str, ...]
    values: Floats
    covariance: Floats
    rates: Floats

    @property
    def u(self) -> Floats:
        """Standard uncertainties, shape (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlation(self) -> Floats:
        """Shape (p, p)."""
        scale = np.where(self.u > 0.0, self.u, 1.0)
        found = self.covariance / np.outer(scale, scale)
        np.fill_diagonal(found, 1.0)
        return np.asarray(found)


def absolute(calibration: Calibration) -> Absolute:
    """Return the estimated parameters with the base in absolute place and angles.

    Where the second angle of the base is ±90° the others are not determined each alone; their uncertainties say so.
    """
    model, found = calibration.model, calibration.estimate
    geometry = calibration.geometry
    turned = np.eye(len(model.chosen))
    values = found.values.copy()
    base = [(k, one.role.part) for k, one in enumerate(model.chosen) if isinstance(one.role, BaseFrame)]
    place, rates = base_place(geometry), base_rates(geometry)
    for k, part in base:
        row = FRAME_PARTS.index(part)
        values[k] = place[row]
        turned[k] = 0.0
        for other, other_part in base:
            turned[k, other] = rates[row, FRAME_PARTS.index(other_part)]
    return Absolute(
        tuple(one.name for one in model.chosen), values, turned @ found.covariance @ turned.T, turned
    )


def base_place(geometry: Geometry) -> Floats:
    """Return place (mm) and angles (deg, R = Rz·Ry·Rx) of the base in the frame of the instrument, shape (6,)."""
    return np.concatenate([geometry.base[:3, 3], angles_of(geometry.base[:3, :3])])


def base_rates(geometry: Geometry) -> Floats:
    """Return how absolute place and angles change with the steps from the closed form, shape (6, 6)."""
    rates = np.zeros((6, 6))
    start, place = geometry.start[:3, :3], base_place(geometry)
    rates[:3, :3] = start
    steps = np.column_stack([start @ turning_axis(geometry.base_steps[3:], part) for part in FRAME_PARTS[3:]])
    angles = np.column_stack([turning_axis(place[3:], part) for part in FRAME_PARTS[3:]])
    rates[3:, 3:] = np.linalg.pinv(angles) @ steps
    return rates
