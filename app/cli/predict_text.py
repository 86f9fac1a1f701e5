"""A predicted path, as sentences, a table and data."""

from typing import Any

import numpy as np

from catseye.app.analysis.path_range import lines_text
from catseye.app.analysis.path_start import start_text
from catseye.app.analysis.validation import TAKE_UP_DEG, established_rows
from catseye.app.cli.output import table
from catseye.app.files.path_csv import CommandPath
from catseye.app.report.numbers import counted
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.prediction import Prediction


def path_warnings(arm: IdentifiedArm, path: CommandPath) -> list[str]:
    """Return what has to be known about the rows of a path, whatever is predicted of them."""
    return [text for text in (_just_reversed(arm, path), _start(arm, path)) if text]


def _just_reversed(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about rows on neither flank of the backlash; empty for a model that knows no directions."""
    if arm.layout.model == "conventional":
        return ""
    loose = ~established_rows(path.commands, float(np.deg2rad(TAKE_UP_DEG)))
    if not loose.any():
        return ""
    return (
        f"in {counted(int(loose.sum()), 'row')} a joint has moved less than {TAKE_UP_DEG:g}° since it reversed "
        f"({lines_text([row.line for row in path.rows], loose)}): their errors hold once the backlash is taken up"
    )


def _start(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about a first row that the path leaves against its state; joint commands tell theirs."""
    return "" if arm.layout.model == "conventional" or not path.cartesian else start_text(path.commands)


def prediction_facts(prediction: Prediction) -> dict[str, Any]:
    """Return a prediction in a few numbers."""
    inside = prediction.inside
    error_um = 1e3 * np.hypot(*prediction.error_mm[inside].T)
    u_um = 1e3 * np.hypot(*prediction.u_mm[inside].T)
    return {
        "rows": int(inside.size),
        "predicted": int(inside.sum()),
        "rms_um": float(np.sqrt(np.mean(error_um**2))),
        "max_um": float(error_um.max()),
        "median_u_um": float(np.median(u_um)),
        "max_u_um": float(u_um.max()),
    }


def prediction_table(prediction: Prediction) -> str:
    """Return the same numbers as a table."""
    facts = prediction_facts(prediction)
    rows = [
        ["rows predicted", "", f"{facts['predicted']} of {facts['rows']}"],
        ["error of the arm, 2-D rms", "µm", f"{facts['rms_um']:.1f}"],
        ["error of the arm, largest", "µm", f"{facts['max_um']:.1f}"],
        ["its standard uncertainty, 2-D median", "µm", f"{facts['median_u_um']:.1f}"],
        ["its standard uncertainty, 2-D largest", "µm", f"{facts['max_u_um']:.1f}"],
    ]
    return table(["predicted minus command", "unit", "value"], rows)
