"""calibrate: identification of a serial arm."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, Output
from catseye.app.cli.output import note, write_json
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.files.atomic import require_output


class Model(StrEnum):
    """What is identified."""

    AUTO = "auto"
    FRAMES = "frames"
    GEOMETRIC = "geometric"
    COMPLIANCE = "geometric+compliance"
    MAPS = "maps"


def calibrate(
    arm: Annotated[
        str, typer.Option(metavar="NAME|FILE", help="arm: a shipped one, irb120 for example, or a TOML")
    ],
    output: Output,
    poses: Annotated[
        list[Path],
        typer.Option(metavar="FILE", help="measured poses CSV; several times for several instruments"),
    ],
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
    as_json: AsJson = False,
) -> None:
    """Identify the geometry and the compliances of a serial arm from measured poses.

    Example: catseye calibrate --poses poses.csv --arm irb120 --tool plate.toml -o arm.json
    """
    from catseye.app.cell.arm import arm_description
    from catseye.app.cell.tool import read_tool
    from catseye.app.results.serial_arm.calibrate import Subject, calibrate_tables
    from catseye.app.results.serial_arm.calibration_report import calibration_report
    from catseye.app.results.serial_arm.result import serial_arm_summary, write_serial_arm

    require_output(output, *poses)
    subject = Subject(arm, arm_description(arm), None if tool is None else read_tool(tool))
    result = calibrate_tables(subject, poses, anchors, model.value)
    write_serial_arm(result, output)
    report = calibration_report(f"Calibration of {arm}", result)
    note_statements(report)
    if as_json:
        write_json({"output": str(output), **serial_arm_summary(result)})
    else:
        write_tables(report)
    note(f"{output} written")
