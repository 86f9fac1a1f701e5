"""Places of the tool's targets that are taken as exact although the measurements contradict them."""

from dataclasses import replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.fitted import identified
from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.left_out_poses import NOT_IDENTIFIED

_DRAWN_MM = 1.0
"""Standard uncertainty of places that are taken from a drawing or by ruler."""

_FAR_BETTER = 0.5
"""Share of the misfit that is left where the places explain it."""


def contradicted_places(arm: SerialArm, found: Calibration) -> str | None:
    """Return what is said of a tool whose places explain most of what is left; None where they do not.

    Args:
        arm: nominal, with the targets as the tool's file has them.
    """
    used = found.model.measurements.targets
    exact = [k for k in used if arm.targets[k].u_mm == 0.0 and any(arm.targets[k].place_mm)]
    if not exact:
        return None
    doubted = [
        replace(one, u_mm=_DRAWN_MM) if number in exact else one for number, one in enumerate(arm.targets)
    ]
    try:
        freed = identified(arm.with_targets(tuple(doubted)), found.model.measurements, found.name)
    except NOT_IDENTIFIED:
        return None
    before, left = _left_mm(found), _left_mm(freed)
    if left >= _FAR_BETTER * before:
        return None
    off = freed.geometry.tools[exact, :3, 3] - np.array([arm.targets[k].place_mm for k in exact])
    worst = int(np.argmax(np.linalg.norm(off, axis=1)))
    return (
        f"the places of the tool's targets are taken as exact, and the measurements contradict them: {before:.3g} mm "
        f"rms are left, and {left:.3g} mm with places that are uncertain by {_DRAWN_MM:g} mm ("
        f"{arm.targets[exact[worst]].name} is {np.linalg.norm(off[worst]):.2g} mm away then). State u_mm of the "
        "targets in the tool's file, or measure their places"
    )


def _left_mm(found: Calibration) -> float:
    """Return what is left of the measured rows, rms of a degree of freedom."""
    rows = found.model.measured_rows
    left: Floats = found.estimate.residuals_mm[:rows]
    return float(np.sqrt(np.sum(np.square(left)) / max(rows - found.estimate.values.size, 1)))
