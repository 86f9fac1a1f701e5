"""init: a cell file to begin with."""

from pathlib import Path
from typing import Annotated, Final, Literal

import typer

from catseye.app.cell.resolution.template import TEMPLATE as RESOLUTION
from catseye.app.cell.scara.template import TEMPLATE as SCARA
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically

System = Literal["scara", "resolution"]

_TEMPLATES: Final[dict[System, str]] = {"scara": SCARA, "resolution": RESOLUTION}


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="cell file to write; never overwritten")],
    system: Annotated[System, typer.Option("--system", help="what is measured")] = "scara",
) -> None:
    """Write a commented cell file for an RH-3FRH5515 with the paper's reflectors and commands.

    With --system resolution it is one for motion resolution: a KUKA KR 210 R2700 with optics beside it.

    Example: catseye init cell.toml
    """
    if file.exists():
        raise UsageError(f"{file} exists already; choose another name or remove it")
    if not file.parent.is_dir():
        raise UsageError(f"{file.parent} is no folder; make it first")
    write_atomically(file, _TEMPLATES[system])
    note(f"{file} written. Next: catseye emulate {file}, and in another terminal: catseye doctor {file}")
