"""init: a cell file to begin with."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="cell file to write; never overwritten")],
) -> None:
    """Write a commented cell file for an RH-3FRH5515 with the paper's reflectors and commands.

    Example: catseye init cell.toml
    """
    if file.exists():
        raise UsageError(f"{file} exists already; choose another name or remove it")
    if not file.parent.is_dir():
        raise UsageError(f"{file.parent} is no folder; make it first")
    write_atomically(file, TEMPLATE)
    note(f"{file} written. Next: catseye emulate {file}, and in another terminal: catseye doctor {file}")
