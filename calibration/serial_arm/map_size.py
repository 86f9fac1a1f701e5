"""How large the errors of an arm's joints are, about which maps are estimated: from the measurements alone."""

from dataclasses import replace

import numpy as np

from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.core.types import Bools
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.identification import Calibration, estimated_again, identify_arm
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.parameters import Harmonic, MapNode

SIZES_DEG = (0.003, 0.01, 0.03)
"""Standard deviations of the maps' amplitudes among joints that are tried."""

_BEGUN_DEG = SIZES_DEG[0]


def identify_maps(arm: SerialArm, measurements: Measurements) -> Calibration:
    """Identify the model with maps, whose amplitudes are as large beforehand as the measurements make likeliest.

    Raises:
        CalibrationError: as of `identify_arm`.
    """
    begun = identify_arm(arm, measurements, "maps", harmonic_u_deg=_BEGUN_DEG)
    amplitudes = np.array(
        [isinstance(one.role, Harmonic | MapNode) and one.u == _BEGUN_DEG for one in begun.model.chosen]
    )
    size_deg = _likeliest_deg(begun, amplitudes) if amplitudes.any() else _BEGUN_DEG
    return (
        begun
        if size_deg == _BEGUN_DEG
        else estimated_again(begun, _with_u(begun.model, amplitudes, size_deg))
    )


def _likeliest_deg(found: Calibration, amplitudes: Bools) -> float:
    """Return the likeliest standard deviation, by restricted likelihood: amplitudes are errors that rows share.

    Args:
        amplitudes: flags of the parameters, shape (p,).
    """
    values = found.estimate.values
    # What was known of the amplitudes is what is looked for: its rows are left away.
    model = _with_u(found.model, amplitudes, None)
    jacobian = model.jacobian(values)
    likelihoods = restricted_log_likelihoods(
        whitening_at(model, values),
        jacobian[:, ~amplitudes],
        model.residuals(values) - jacobian[:, amplitudes] @ values[amplitudes],
        jacobian[:, amplitudes],
        SIZES_DEG,
    )
    return SIZES_DEG[int(np.argmax(likelihoods))]


def _with_u(model: ArmModel, amplitudes: Bools, u_deg: float | None) -> ArmModel:
    chosen = tuple(
        replace(one, u=u_deg) if amplitude else one
        for one, amplitude in zip(model.chosen, amplitudes, strict=True)
    )
    return replace(model, chosen=chosen)
