"""A base that moves against the instrument while the poses are measured: how much, from the measurements alone."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.parameters import BaseFrame

_SHIFTS = (BaseFrame("x_mm"), BaseFrame("y_mm"), BaseFrame("z_mm"))

_TRIED_MM = (0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.35, 0.5, 1.0)
"""Sizes of the drift between the first and the last pose that are tried."""

_INTERVALS = 12
"""The drift is linear in so many intervals of the measuring order."""

SIGNIFICANT_GAIN = 2.71
"""Gain of the logarithm of the likelihood that chance exceeds once in a hundred times: half of the 0.98 quantile of
χ² with one degree of freedom, since a size cannot be negative."""


@dataclass(frozen=True)
class Drift:
    """What the base moved by.

    Attributes:
        size_mm: standard deviation of each coordinate between the first and the last pose.
        gain: logarithm of the likelihood beyond that of no drift.
    """

    size_mm: float
    gain: float


def find_drift(calibration: Calibration) -> Drift | None:
    """Return the likeliest drift of the base; None where none is seen beyond chance, or nothing would show it."""
    model, values = calibration.model, calibration.estimate.values
    unit = _of_unit_size(model, values)
    if unit is None:
        return None
    sizes = (0.0, *_TRIED_MM)
    likelihoods = restricted_log_likelihoods(
        whitening_at(model, values),
        model.jacobian(values),
        calibration.estimate.residuals_mm,
        unit.effects_mm,
        sizes,
    )
    best = int(np.argmax(likelihoods))
    gain = float(likelihoods[best] - likelihoods[0])
    return Drift(sizes[best], gain) if gain > SIGNIFICANT_GAIN else None


def drift_errors(model: ArmModel, values: Floats, drift: Drift) -> Shared:
    """Return what rows share under a drift of the base."""
    unit = _of_unit_size(model, values)
    effects = np.zeros((model.rows, 0)) if unit is None else drift.size_mm * unit.effects_mm
    return Shared("drift of the base", effects)


def _of_unit_size(model: ArmModel, values: Floats) -> Shared | None:
    """Return what rows share under a drift of 1 mm; None where the base is not in the frame of an instrument."""
    shifts = [k for k, one in enumerate(model.chosen) if one.role in _SHIFTS]
    if len(shifts) < len(_SHIFTS):
        return None
    moved = model.jacobian(values)[:, shifts]
    measured = model.pose_of_row >= 0
    numbers = np.unique(model.pose_of_row[measured])
    place = np.interp(model.pose_of_row, numbers, np.linspace(0.0, 1.0, len(numbers)))
    steps = np.clip(place[:, None] * _INTERVALS - np.arange(_INTERVALS), 0.0, 1.0) / np.sqrt(_INTERVALS)
    # The base of the calibration is where it stood on the average.
    steps -= steps[measured].mean(axis=0)
    steps[~measured] = 0.0
    return Shared("drift of the base", (moved[:, :, None] * steps[:, None, :]).reshape(len(moved), -1))
