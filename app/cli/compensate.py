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
    typer.Option(help="of a SCARA: path file, CSV or TOML segments; a table (kw-ssfk) needs none"),
]
Poses = Annotated[Path | None, typer.Option(metavar="FILE", help="of a serial arm: poses CSV of the program")]
FormOption = Annotated[
    Form,
    typer.Option(
        "--format", help="what to write; rapid and krl of serial arms, json, melfa, kw-ssfk of a SCARA"
    ),
]
Target = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="of a serial arm: place of the tool that is to be right [flange]"),
]
Approach = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=90.0,
        metavar="DEG",
        help="of a serial arm, rapid and krl: write before each pose one so far on the side that its joints come "
        "from [none]",
    ),
]
CheckedBy = Annotated[
    Path | None, typer.Option(help="cell file whose joint limits and bodies the commands have to keep to")
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
    """Turn the model round: commands that bring the arm where it shall go, or a bidirectional table.

    Example: catseye compensate result.json --path path.csv --format melfa --cell cell.toml -o path.prg
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(result):
        from catseye.app.cli.serial_arm.compensate import compensate as compensate_poses

        if poses is None or path is not None:
            raise UsageError(f"{result} is of a serial arm: give --poses FILE, a poses CSV, and no --path")
        if format_ not in ("csv", "rapid", "krl"):
            raise UsageError(f"{result} is of a serial arm: --format is csv, rapid or krl")
        if approach and format_ == "csv":
            raise UsageError(
                "--approach is for --format rapid and krl: a CSV says in direction1 … from which side each joint is "
                "to come"
            )
        return compensate_poses(result, poses, format_, output, target, approach, as_json=as_json)
    from catseye.app.cli.scara.compensate import compensate as compensate_path

    if format_ == "rapid" or format_ == "krl" or poses is not None or target is not None or approach:
        raise UsageError(
            f"{result} is of a SCARA: give --path FILE and --format csv, json, melfa or kw-ssfk; --poses, --target, "
            "--approach, rapid and krl are for serial arms"
        )
    return compensate_path(
        result, output, path, format_, hand, start_direction, cell, flange_deg, as_json=as_json
    )
