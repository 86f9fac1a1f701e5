"""predict: where the model says the arm really goes."""

from pathlib import Path

from catseye.app.commands.output import emit, emit_json, say
from catseye.app.files.atomic import require_other_file
from catseye.app.files.identified_arm import nominal_of
from catseye.app.files.path_csv import read_path_csv, start_states
from catseye.app.files.predicted_csv import write_predicted_csv
from catseye.app.files.result_json import read_result
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.scara.prediction import predict_path
from catseye.app.results.scara.prediction_report import prediction_report
from catseye.calibration.kinematics import Hand


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
    nominal = nominal_of(identified)[0]
    commanded = read_path_csv(path, nominal, hand, start_states(start_direction))
    predicted = predict_path(identified, commanded, str(path))
    write_predicted_csv(commanded, predicted.prediction, output)
    report = prediction_report(predicted)
    for line in statement_lines(report):
        say(line)
    if as_json:
        warnings = list(predicted.warnings)
        emit_json(
            {"output": str(output), "model": predicted.model, **predicted.figures(), "warnings": warnings}
        )
    else:
        emit(tables_text(report))
    say(f"{output} written")
