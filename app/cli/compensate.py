"""compensate: commands that bring the arm where it shall go; the kind of result decides."""

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import typer

from catseye.app.cli.options import AsJson, Output, ResultFile
from catseye.app.cli.scara.options import FlangeAngle, Hand, StartDirection
from catseye.app.errors import UsageError

Form: TypeAlias = Literal["csv", "json", "melfa", "kw-ssfk", "rapid", "krl"]

CommandPath = Annotated[
    Path | None,
    typer.Option(help="SCARA: path file (CSV or TOML); kw-ssfk needs none"),
]
Poses = Annotated[Path | None, typer.Option(metavar="FILE", help="serial arm: poses CSV of the program")]
FormOption = Annotated[
    Form,
    typer.Option(
        "--format", help="format to write; rapid and krl for serial arms; json, melfa and kw-ssfk for a SCARA"
    ),
]
Target = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", help="serial arm: target of the tool to bring to the intended place [flange]"
    ),
]
Approach = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=90.0,
        metavar="DEG",
        help="serial arm, rapid and krl: write a pose before each one, this far away on the side of approach [none]",
    ),
]
CheckedBy = Annotated[
    Path | None, typer.Option(help="cell file whose joint limits and bodies the commands must respect")
]


def compensate(
    result: ResultFile,
    output: Output,
    path: CommandPath = None,
    poses: Poses = None,
    format_: FormOption = "csv",
    target: Target = None,
    approach: Approach = 0.0,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    cell: CheckedBy = None,
    flange_deg: FlangeAngle = 0.0,
    as_json: AsJson = False,
) -> None:
    """Correct commands or write compensation tables. The commands bring the arm to the desired positions.

    Example: catseye compensate result.json --path path.csv --format melfa --cell cell.toml -o path.prg
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(result):
        from catseye.app.cli.serial_arm.compensate import compensate as compensate_poses

        if poses is None or path is not None:
            raise UsageError(f"{result} is for a serial arm: give --poses FILE, a poses CSV, and no --path")
        if format_ not in ("csv", "rapid", "krl"):
            raise UsageError(f"{result} is for a serial arm: --format is csv, rapid or krl")
        if approach and format_ == "csv":
            raise UsageError(
                "--approach is for --format rapid and krl: a CSV says in direction1 … from which side each joint is "
                "to come"
            )
        return compensate_poses(result, poses, format_, output, target, approach, as_json=as_json)
    from catseye.app.cli.scara.compensate import compensate as compensate_path

    if format_ == "rapid" or format_ == "krl" or poses is not None or target is not None or approach:
        raise UsageError(
            f"{result} is for a SCARA: give --path FILE and --format csv, json, melfa or kw-ssfk; --poses, --target, "
            "--approach, rapid and krl are for serial arms"
        )
    return compensate_path(
        result, output, path, format_, hand, start_direction, cell, flange_deg, as_json=as_json
    )
