"""predict: where the model says the arm really goes."""

from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.analysis.path_range import lines_text, outside_text
from catseye.app.analysis.path_start import start_text
from catseye.app.analysis.validation import TAKE_UP_DEG, established_rows
from catseye.app.commands.output import emit, emit_json, say, table
from catseye.app.errors import MeasurementRejectedError
from catseye.app.files.atomic import require_other_file
from catseye.app.files.identified_arm import arm_of, arm_remarks, nominal_of
from catseye.app.files.path_csv import CommandPath, read_path_csv, start_states
from catseye.app.files.predicted_csv import write_predicted_csv
from catseye.app.files.result_json import read_result
from catseye.app.report.numbers import counted
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import Hand
from catseye.calibration.scara.prediction import Prediction, predict


def predict_command(
    result: Path, path: Path, output: Path, hand: Hand, start_direction: str, as_json: bool
) -> None:
    """Write the prediction of a path.

    Raises:
        UsageError: a file or an option is wrong.
        MeasurementRejectedError: no row lies inside the identified range; nothing is written.
    """
    require_other_file(output, result, path)
    identified = read_result(result)
    arm, (nominal, _) = arm_of(identified), nominal_of(identified)
    commanded = read_path_csv(path, nominal, hand, start_states(start_direction))
    outside = outside_text(arm, commanded.commands, _lines(commanded))
    prediction = predict(arm, commanded.commands, *nominal)
    if not prediction.inside.any():
        raise MeasurementRejectedError(
            f"{path}: {outside}. Nothing is left to predict, and nothing was written"
        )
    warnings = [*arm_remarks(identified), outside, _just_reversed(arm, commanded), _start(arm, commanded)]
    warnings = [text for text in warnings if text]
    write_predicted_csv(commanded, prediction, output)
    for text in warnings:
        say(f"warning: {text}")
    if as_json:
        emit_json(
            {"output": str(output), "model": arm.layout.model, **_facts(prediction), "warnings": warnings}
        )
    else:
        emit(_summary(prediction))
    say(f"{output} written")


def _lines(path: CommandPath) -> list[int]:
    return [row.line for row in path.rows]


def _just_reversed(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about rows on neither flank of the backlash; empty for a model that knows no directions."""
    if arm.layout.model == "conventional":
        return ""
    loose = ~established_rows(path.commands, float(np.deg2rad(TAKE_UP_DEG)))
    if not loose.any():
        return ""
    return (
        f"in {counted(int(loose.sum()), 'row')} a joint has moved less than {TAKE_UP_DEG:g}° since it reversed "
        f"({lines_text(_lines(path), loose)}): their errors hold once the backlash is taken up"
    )


def _start(arm: IdentifiedArm, path: CommandPath) -> str:
    """Return a sentence about a first row that the path leaves against its state; joint commands tell theirs."""
    return "" if arm.layout.model == "conventional" or not path.cartesian else start_text(path.commands)


def _facts(prediction: Prediction) -> dict[str, Any]:
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


def _summary(prediction: Prediction) -> str:
    facts = _facts(prediction)
    rows = [
        ["rows predicted", "", f"{facts['predicted']} of {facts['rows']}"],
        ["error of the arm, 2-D rms", "µm", f"{facts['rms_um']:.1f}"],
        ["error of the arm, largest", "µm", f"{facts['max_um']:.1f}"],
        ["its standard uncertainty, 2-D median", "µm", f"{facts['median_u_um']:.1f}"],
        ["its standard uncertainty, 2-D largest", "µm", f"{facts['max_u_um']:.1f}"],
    ]
    return table(["predicted minus command", "unit", "value"], rows)
