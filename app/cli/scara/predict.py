"""predict, of a SCARA: where the model says the arm really goes on a path."""

from pathlib import Path

from catseye.app.cli.output import note, write_document
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.scara.options import HandName
from catseye.app.files.atomic import require_output


def predict(
    result: Path,
    path: Path,
    output: Path,
    hand: HandName = "right",
    start_direction: str = "1,1",
    as_json: bool = False,
) -> None:
    """Predict a path."""
    from catseye.app.results.scara.identified_arm import nominal_of
    from catseye.app.results.scara.path_csv import read_path_csv, start_states
    from catseye.app.results.scara.prediction import predict_path, prediction_report, write_predicted_csv
    from catseye.app.results.scara.result import read_result

    require_output(output, result, path)
    identified = read_result(result)
    nominal = nominal_of(identified)[0]
    commanded = read_path_csv(path, nominal, hand, start_states(start_direction))
    predicted = predict_path(identified, commanded, str(path))
    write_predicted_csv(commanded, predicted.prediction, output)
    report = prediction_report(predicted)
    note_statements(report)
    if as_json:
        write_document("path-prediction", predicted.document(output).json_object())
    else:
        write_tables(report)
    note(f"{output} written")
