"""calibrate: identification of a serial arm."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

import typer

from catseye.app.cli.options import AcceptImplausible, AsJson, MeasuredRuns, Output, Runs, Unverified
from catseye.app.cli.output import note, write_document
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.serial_arm.measured_runs import measured_runs
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output


class Model(StrEnum):
    """What is identified."""

    AUTO = "auto"
    FRAMES = "frames"
    GEOMETRIC = "geometric"
    COMPLIANCE = "geometric+compliance"
    MAPS = "maps"


ArmName = Annotated[
    str | None,
    typer.Option(
        metavar="NAME|FILE",
        help="name of a shipped arm, such as irb120, or path of an arm description [that of the run]",
    ),
]
PoseTables = Annotated[
    list[Path] | None,
    typer.Option(metavar="FILE", help="measured poses CSV; may be repeated, one for each instrument"),
]
Anchors = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="anchors CSV for distances; anchors without coordinates are identified"
    ),
]
Tool = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="tool TOML; without it the positions of the targets are identified"),
]
ModelChoice = Annotated[
    Model,
    typer.Option(
        help="model to identify; auto: the simplest one that predicts left-out poses as well as the best"
    ),
]
Priors = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="priors CSV (name,u[,value]): prior knowledge of parameters"),
]
RowLoss = Annotated[
    Literal["squares", "huber", "soft-l1"],
    typer.Option(help="loss function; the robust ones keep all poses and give wrong ones less weight"),
]
Propagation = Annotated[
    Literal["jacobian", "monte-carlo"], typer.Option(help="how to propagate uncertainties")
]


def calibrate(
    output: Output,
    run: MeasuredRuns = None,
    arm: ArmName = None,
    poses: PoseTables = None,
    anchors: Anchors = None,
    tool: Tool = None,
    model: ModelChoice = Model.AUTO,
    priors: Priors = None,
    loss: RowLoss = "squares",
    uncertainty: Propagation = "jacobian",
    draws: Annotated[int, typer.Option(help="number of Monte Carlo draws, at least 2000")] = 10_000,
    seed: Annotated[int, typer.Option(min=0, help="seed of the Monte Carlo draws")] = 1,
    accept_implausible: AcceptImplausible = None,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Identify geometry and compliance of a serial arm. The data are runs, tables of measured poses, or both.

    Example: catseye calibrate --poses poses.csv --arm irb120 --tool plate.toml -o arm.json
    """
    from catseye.app.cell.tool import read_tool
    from catseye.app.results.serial_arm.calibrate import (
        Method,
        MonteCarlo,
        Sources,
        Subject,
        calibrate_tables,
    )
    from catseye.app.results.serial_arm.calibration_document import calibration_document
    from catseye.app.results.serial_arm.calibration_report import calibration_report
    from catseye.app.results.serial_arm.result import write_serial_arm

    tables = poses or []
    if not run and not tables:
        raise UsageError("nothing to calibrate with: name runs, or tables by --poses FILE")
    require_output(output, *tables, anchors, tool, priors)
    method = Method(
        model.value,
        None if loss == "squares" else loss,
        MonteCarlo(draws, seed) if uncertainty == "monte-carlo" else None,
        accept_implausible,
    )
    with measured_runs(run or (), runs, unverified=unverified, beside=bool(tables)) as given:
        name, description, carried = given.subject(arm, None if tool is None else read_tool(tool))
        sources = Sources([*given.tables, *tables], anchors, priors)
        result = calibrate_tables(Subject(name, description, carried), sources, method)
        result = given.stated(result, tables)
    write_serial_arm(result, output)
    report = calibration_report(f"Calibration of {name}", result)
    note_statements(report)
    if as_json:
        write_document("calibration", calibration_document(result, output))
    else:
        write_tables(report)
    note(f"{output} written")
