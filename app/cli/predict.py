"""predict: where the model says the arm really goes."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, Hand, Output, ResultFile, StartDirection
from catseye.app.cli.output import emit, emit_json, say, warn


def predict(
    result: ResultFile,
    path: Annotated[Path, typer.Option(help="path CSV, in joints or Cartesian")],
    output: Output,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    as_json: AsJson = False,
) -> None:
    """Tell where the model says the arm really goes, with uncertainties; beyond the identified range it says nothing.

    Example: catseye predict result.json --path path.csv -o predicted.csv
    """
    from catseye.app.analysis.path_range import outside_text
    from catseye.app.cli.predict_text import path_warnings, prediction_facts, prediction_table
    from catseye.app.errors import MeasurementRejectedError
    from catseye.app.files.atomic import require_output
    from catseye.app.files.identified_arm import arm_of, arm_remarks, nominal_of
    from catseye.app.files.path_csv import read_path_csv, start_states
    from catseye.app.files.predicted_csv import write_predicted_csv
    from catseye.app.files.result_json import read_result
    from catseye.calibration.scara import prediction

    require_output(output, result, path)
    identified = read_result(result)
    arm, (nominal, _) = arm_of(identified), nominal_of(identified)
    commanded = read_path_csv(path, nominal, hand, start_states(start_direction))
    outside = outside_text(arm, commanded.commands, [row.line for row in commanded.rows])
    predicted = prediction.predict(arm, commanded.commands, *nominal)
    if not predicted.inside.any():
        raise MeasurementRejectedError(
            f"{path}: {outside}. Nothing is left to predict, and nothing was written"
        )
    warnings = [*arm_remarks(identified), *([outside] if outside else []), *path_warnings(arm, commanded)]
    write_predicted_csv(commanded, predicted, output)
    for text in warnings:
        warn(text)
    if as_json:
        facts = prediction_facts(predicted)
        emit_json({"output": str(output), "model": arm.layout.model, **facts, "warnings": warnings})
    else:
        emit(prediction_table(predicted))
    say(f"{output} written")
