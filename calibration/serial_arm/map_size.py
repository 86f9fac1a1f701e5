"""How large the errors of an arm's joints are, about which maps are estimated: from the measurements alone."""

from dataclasses import replace

import numpy as np

from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.identification import Calibration, identify_arm
from catseye.calibration.serial_arm.measurements import Measurements
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
    size_deg = _likeliest_deg(begun)
    if size_deg == _BEGUN_DEG:
        return begun
    return identify_arm(arm, measurements, "maps", harmonic_u_deg=size_deg)


def _likeliest_deg(found: Calibration) -> float:
    """Return the likeliest standard deviation, by restricted likelihood: amplitudes are errors that rows share."""
    model, values = found.model, found.estimate.values
    amplitudes = np.array(
        [isinstance(one.role, Harmonic | MapNode) and one.u == _BEGUN_DEG for one in model.chosen]
    )
    if not amplitudes.any():
        return _BEGUN_DEG
    # What was known of the amplitudes is what is looked for: its rows, which stand last, are left away.
    others = replace(
        model,
        chosen=tuple(
            replace(one, u=None) if amplitude else one
            for one, amplitude in zip(model.chosen, amplitudes, strict=True)
        ),
    )
    jacobian = others.jacobian(values)
    residuals = others.residuals(values) - jacobian[:, amplitudes] @ values[amplitudes]
    likelihoods = restricted_log_likelihoods(
        whitening_at(others, values),
        jacobian[:, ~amplitudes],
        residuals,
        jacobian[:, amplitudes],
        SIZES_DEG,
    )
    return SIZES_DEG[int(np.argmax(likelihoods))]
