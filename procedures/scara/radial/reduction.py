"""From stored readings to the error motion of a joint."""

from collections.abc import Sequence

import numpy as np

from catseye.calibration.standards.error_motion import ErrorMotion, RunOut
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.kit.stored import integer, number_of

_ACROSS_DEG = {"x": 0.0, "y": 90.0}


def run_out_of(readings: Sequence[Row]) -> RunOut:
    """Return the readings of one joint, as `RunOutReading` stores them."""
    return RunOut(
        angle_rad=np.deg2rad([number_of(row, "angle_deg") for row in readings]),
        direction_rad=np.deg2rad([_ACROSS_DEG[str(row["direction"])] for row in readings]),
        reading_um=np.array([number_of(row, "reading_um") for row in readings]),
        approach=np.array([integer(row["approach"]) for row in readings]),
        cycle=np.array([integer(row["cycle"]) for row in readings]),
        zero=np.array([integer(row["zero"]) for row in readings]),
        turned=np.array([row["mounting"] == "turned" for row in readings]),
    )


def motion_row(joint: str, found: ErrorMotion) -> dict[str, Json]:
    """Return what was found of a joint, as a step stores it."""
    from_deg, to_deg = np.rad2deg(found.angle_rad[[0, -1]]).round(3).tolist()
    form_um = None if found.form_um is None else float(np.ptp(found.form_um, axis=1).max())
    return {
        "joint": joint,
        "from_deg": from_deg,
        "to_deg": to_deg,
        "places": found.angle_rad.size,
        "rms_um": found.rms_um,
        "u_rms_um": found.u_rms_um,
        "budget_dof": None if np.isinf(found.budget_dof) else found.budget_dof,
        "expanded_average_um": found.expanded_average_um,
        "scatter_um": found.scatter_um,
        "dof": found.dof,
        "eccentricity_um": [each.size_um for each in found.eccentricity],
        "form_um": form_um,
        "values": [
            {
                "direction": "x" if each.direction_rad == 0.0 else "y",
                "total_um": each.total_um,
                "average_um": each.average_um,
                "asynchronous_um": each.asynchronous_um,
                "reversal_um": each.reversal_um,
            }
            for each in found.values
        ],
    }
