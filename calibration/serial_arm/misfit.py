"""How far the nominal arm is off measurements, and how far an arm may be."""

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.closed_form import closed_form
from catseye.calibration.serial_arm.identification import parameters_of
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.orientations import places_only

_SOUND_SHARE = 0.02
"""A nominal arm misses its targets by less than this share of its reach: a centimetre of half a metre."""


def misfit_mm(arm: SerialArm, rows: Measurements) -> float:
    """Return how far the nominal arm is off, with base, unknown targets and anchors in closed form, rms."""
    if len(rows.points.pose):
        arm, rows = places_only(arm, rows)
    residuals = residuals_mm(arm, rows)
    return np.inf if residuals is None else float(np.sqrt(np.mean(np.square(residuals))))


def residuals_mm(arm: SerialArm, rows: Measurements) -> Floats | None:
    """Return the residuals of the nominal arm; None where the rows do not put it anywhere."""
    try:
        start = closed_form(arm, rows)
    except CalibrationError:
        return None
    model = ArmModel(arm, start.frame, parameters_of(arm, rows, "frames"), rows)
    return model.residuals(model.start_values(start))[: model.measured_rows]


def reach_mm(arm: SerialArm) -> float:
    """Return how far the links reach, one behind the other, mm."""
    return sum(abs(joint.a_mm) + joint.longest_mm for joint in arm.chain.joints)


def fits(arm: SerialArm, misfit: float) -> bool:
    """Return whether an arm may be wrong by so much, mm rms."""
    return misfit < _SOUND_SHARE * reach_mm(arm)
