"""validate: a model against an independent measurement; the kind of result decides."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson, ResultFile, Runs
from catseye.app.cli.scara.options import Hand, StartDirection
from catseye.app.cli.serial_arm.measured_runs import measured_runs
from catseye.app.errors import UsageError


def validate(
    result: ResultFile,
    measured: Annotated[
        Path,
        typer.Option(
            metavar="FILE|RUN",
            help="measured CSV: commands and independently measured positions; of a serial arm measured poses; or a "
            "run that measured them",
            autocompletion=completion.runs_and_tables,
        ),
    ],
    reference: Annotated[
        Path | None,
        typer.Option(metavar="RESULT", help="model to compare with, as a rule the conventional one"),
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="HTML page with the figures")] = None,
    limit: Annotated[
        float | None,
        typer.Option("--limit-um", min=0.0, help="2-D rms that may be left; more is exit code 1"),
    ] = None,
    limit_mm: Annotated[
        float | None,
        typer.Option(
            "--limit-mm", min=0.0, help="of a serial arm: mean error that may be left; more is exit code 1"
        ),
    ] = None,
    anchors: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="of a serial arm: anchors CSV of measured distances (ballbar)"),
    ] = None,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Compare a model with an independent measurement.

    Example: catseye validate error-map.json --measured tracker.csv --reference conventional.json -o validation.html
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(result):
        from catseye.app.cli.serial_arm.validate import validate as validate_poses

        if reference is not None or limit is not None:
            raise UsageError(
                f"{result} is of a serial arm: its reference is the arm as drawn, its limit --limit-mm; leave "
                "--reference and --limit-um away"
            )
        # The folder of a run is a run, as everywhere.
        names = [] if measured.is_file() else [str(measured)]
        with measured_runs(names, runs) as given:
            given.require_subject_of(result)
            return validate_poses(result, measured, given, anchors, output, limit_mm, as_json=as_json)
    from catseye.app.cli.scara.validate import validate as validate_scara
    from catseye.app.cli.scara.validate import validate_run

    if limit_mm is not None or anchors is not None:
        raise UsageError(f"{result} is of a SCARA: state its limit by --limit-um, and leave --anchors away")
    if not measured.is_file() and measured.suffix.lower() != ".csv":
        return validate_run(result, str(measured), runs, reference, output, limit, as_json=as_json)
    return validate_scara(result, measured, reference, output, limit, hand, start_direction, as_json=as_json)
