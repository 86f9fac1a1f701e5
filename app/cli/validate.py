"""validate: a model against an independent measurement; the kind of result decides."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson, ResultFile, Runs
from catseye.app.cli.scara.options import Hand, StartDirection
from catseye.app.errors import UsageError

Measured = Annotated[
    Path,
    typer.Option(
        metavar="FILE|RUN",
        help="measured CSV (commands and independently measured positions), for a serial arm measured poses CSV; "
        "or a run that measured them",
        autocompletion=completion.runs_and_tables,
    ),
]
Mapping = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="SCARA: mapping (TOML) for a --measured file written by a tracker's own program"
    ),
]
DrivenPath = Annotated[
    Path | None,
    typer.Option(
        "--path",
        metavar="FILE",
        help="with --mapping: the path that was driven, a path file or a CSV of compensate",
    ),
]
Preview = Annotated[
    bool, typer.Option("--preview", help="show how --measured is read, and write its mapping to stdout")
]
Reference = Annotated[
    Path | None,
    typer.Option(metavar="RESULT", help="model to compare with, usually the conventional one"),
]
Page = Annotated[Path | None, typer.Option("-o", "--output", help="HTML page to write, with figures")]
LimitUm = Annotated[
    float | None,
    typer.Option(
        "--limit-um", min=0.0, help="largest remaining 2-D rms allowed; a larger one gives exit code 1"
    ),
]
LimitMm = Annotated[
    float | None,
    typer.Option(
        "--limit-mm",
        min=0.0,
        help="serial arm: largest remaining mean error allowed; a larger one gives exit code 1",
    ),
]
Anchors = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="serial arm: anchors CSV for measured distances (ballbar)"),
]


def validate(
    result: ResultFile,
    measured: Measured,
    mapping: Mapping = None,
    path: DrivenPath = None,
    preview: Preview = False,
    reference: Reference = None,
    output: Page = None,
    limit: LimitUm = None,
    limit_mm: LimitMm = None,
    anchors: Anchors = None,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Compare a model with an independent measurement.

    Example: catseye validate error-map.json --measured tracker.csv --reference conventional.json -o validation.html;
    catseye validate error-map.json --measured points.txt --preview > tracker.toml;
    catseye validate error-map.json --measured points.txt --mapping tracker.toml --path path.toml
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(result):
        if reference is not None or limit is not None:
            raise UsageError(
                f"{result} is for a serial arm: its reference is the arm as drawn, its limit --limit-mm; omit "
                "--reference and --limit-um"
            )
        if mapping is not None or path is not None or preview:
            raise UsageError(
                f"{result} is for a serial arm: --measured is a poses CSV; omit --mapping, --path and --preview"
            )
        _validate_poses(result, measured, anchors, output, limit_mm, runs, as_json=as_json)
        return
    if limit_mm is not None or anchors is not None:
        raise UsageError(f"{result} is for a SCARA: state its limit by --limit-um, and omit --anchors")
    from catseye.app.cli.scara.validate import Wanted, validate_path

    validate_path(
        Wanted(result, measured, reference, output, limit, hand, start_direction, mapping, path, as_json),
        runs,
        preview=preview,
    )


def _validate_poses(
    result: Path,
    measured: Path,
    anchors: Path | None,
    output: Path | None,
    limit_mm: float | None,
    runs: Path | None,
    *,
    as_json: bool,
) -> None:
    from catseye.app.cli.serial_arm.measured_runs import measured_runs
    from catseye.app.cli.serial_arm.validate import validate as validate_poses

    # The folder of a run is a run, as everywhere.
    names = [] if measured.is_file() else [str(measured)]
    with measured_runs(names, runs) as given:
        given.require_subject_of(result)
        validate_poses(result, measured, given, anchors, output, limit_mm, as_json=as_json)
