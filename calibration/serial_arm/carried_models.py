"""Which models measurements carry: those that they identify, with rows enough for their effective parameters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.fitted import identified
from catseye.calibration.serial_arm.held_out import effective_parameters
from catseye.calibration.serial_arm.identification import ModelName
from catseye.calibration.serial_arm.left_out_poses import NOT_IDENTIFIED
from catseye.calibration.serial_arm.measurements import Measurements

_ROWS_A_PARAMETER = 2.0
"""Coordinates that each effective parameter of a model needs: with fewer, chance decides what it becomes."""

_COORDINATES = 6
"""Of a pose: more rows only repeat them."""


@dataclass(frozen=True)
class Carried:
    """Which models the measurements carry.

    Attributes:
        able: those that they do, the simplest first.
        effective: parameters that the rows pay for, of each that is identified.
        reasons: why they do not carry others.
    """

    able: list[ModelName]
    effective: dict[ModelName, float]
    reasons: dict[ModelName, str]


def carried_models(arm: SerialArm, rows: Measurements, names: Sequence[ModelName]) -> Carried:
    """Return the models that measurements carry; the simplest that they identify is carried anyhow.

    Raises:
        CalibrationError: none is identified.
    """
    found, error, coordinates = Carried([], {}, {}), None, _coordinates(rows)
    for name in names:
        try:
            effective = effective_parameters(identified(arm, rows, name))
        except NOT_IDENTIFIED as why:
            error = error or why
            found.reasons[name] = str(why)
            continue
        found.effective[name] = effective
        if found.able and _ROWS_A_PARAMETER * effective > coordinates:
            found.reasons[name] = (
                f"{effective:.0f} effective parameters from {coordinates} coordinates, which carry "
                f"{coordinates / _ROWS_A_PARAMETER:.0f}: measure at more poses"
            )
        else:
            found.able.append(name)
    if not found.able:
        raise error or InsufficientPointsError("there is no model to identify")
    return found


def _coordinates(rows: Measurements) -> int:
    """Return how many coordinates of poses were measured."""
    threefold = np.repeat(np.concatenate([rows.points.pose, rows.orientations.pose]), 3)
    counts = np.unique(np.concatenate([threefold, rows.distances.pose]), return_counts=True)[1]
    return int(np.minimum(counts, _COORDINATES).sum())
