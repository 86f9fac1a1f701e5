"""calibrate: identification of a serial arm."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, MeasuredRuns, Output, Runs, Unverified
from catseye.app.cli.output import note, write_json
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


def calibrate(
    output: Output,
    run: MeasuredRuns = None,
    arm: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE", help="arm: a shipped one, irb120 for example, or a TOML; of a run its own"
        ),
    ] = None,
    poses: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="measured poses CSV; several times for several instruments"),
    ] = None,
    anchors: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="anchors CSV of distances; an empty place is identified"),
    ] = None,
    tool: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="tool TOML; without it the places of targets are identified"),
    ] = None,
    model: Annotated[
        Model, typer.Option(help="auto: the one that predicts left-out poses best")
    ] = Model.AUTO,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Identify the geometry and the compliances of a serial arm from measured poses: runs, tables, or both.

    Example: catseye calibrate --poses poses.csv --arm irb120 --tool plate.toml -o arm.json
    """
    from catseye.app.cell.arm import arm_description
    from catseye.app.cell.tool import read_tool
    from catseye.app.results.serial_arm.calibrate import Subject, calibrate_tables
    from catseye.app.results.serial_arm.calibration_report import calibration_report
    from catseye.app.results.serial_arm.result import serial_arm_summary, write_serial_arm

    tables = poses or []
    if not run and not tables:
        raise UsageError("nothing to calibrate with: name runs, or tables by --poses FILE")
    require_output(output, *tables)
    with measured_runs(run or (), runs, unverified=unverified) as given:
        cell = given.cell(arm)
        meant = arm if arm is not None or cell is None else cell.robot.arm
        description = arm_description(meant or "")
        name = meant if isinstance(meant, str) else description.name
        carried = read_tool(tool) if tool is not None else None if cell is None else cell.robot.carried
        result = calibrate_tables(
            Subject(name, description, carried), [*given.tables, *tables], anchors, model.value
        )
        result = given.stated(result, tables)
    write_serial_arm(result, output)
    report = calibration_report(f"Calibration of {name}", result)
    note_statements(report)
    if as_json:
        write_json({"output": str(output), **serial_arm_summary(result)})
    else:
        write_tables(report)
    note(f"{output} written")
