"""predict: where a model says the arm really goes; the kind of result decides."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, Output, ResultFile
from catseye.app.cli.scara.options import Hand, StartDirection
from catseye.app.errors import UsageError


def predict(
    result: ResultFile,
    output: Output,
    path: Annotated[Path | None, typer.Option(metavar="FILE", help="SCARA: path file (CSV or TOML)")] = None,
    poses: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="serial arm: poses CSV with a target in each row"),
    ] = None,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    as_json: AsJson = False,
) -> None:
    """Predict where the arm really goes. States uncertainties; commands beyond the identified range get no values.

    Example: catseye predict result.json --path path.toml --start-direction along -o predicted.csv
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(result):
        from catseye.app.cli.serial_arm.predict import predict as predict_poses

        if poses is None or path is not None:
            raise UsageError(f"{result} is for a serial arm: give --poses FILE, a poses CSV, and no --path")
        return predict_poses(result, poses, output, as_json=as_json)
    from catseye.app.cli.scara.predict import predict as predict_path

    if path is None or poses is not None:
        raise UsageError(f"{result} is for a SCARA: give --path FILE, a path file, and no --poses")
    return predict_path(result, path, output, hand, start_direction, as_json=as_json)
