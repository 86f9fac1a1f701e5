"""tui: the terminal user interface."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import Runs, Speed
from catseye.app.store.runs_folder import runs_folder


def tui(
    cell: Annotated[
        Path | None, typer.Option(help="cell file [the only one in this folder, otherwise Set-up]")
    ] = None,
    speed: Speed = 1.0,
    runs: Runs = None,
) -> None:
    """Start the terminal user interface. It joins a running engine or starts one.

    Example: catseye tui --cell cell.toml
    """
    from catseye.app.tui.start import show

    show(cell, runs_folder(runs), speed)
