"""tui: the terminal user interface."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import Runs, Speed
from catseye.app.errors import UsageError
from catseye.app.store.runs_folder import runs_folder


def tui(
    cell: Annotated[
        Path | None, typer.Option(help="cell file [the only one in this folder, otherwise Set-up]")
    ] = None,
    speed: Speed = 1.0,
    campaign: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="lead through the stages of this campaign, with its parameters and limits"
        ),
    ] = None,
    job: Annotated[
        str,
        typer.Option(metavar="ID", help="with --campaign: job that the runs belong to; only its runs count"),
    ] = "",
    runs: Runs = None,
) -> None:
    """Start the terminal user interface. It joins a running engine or starts one.

    Example: catseye tui --cell cell.toml; catseye tui --cell cell.toml --campaign night.toml --job night-12
    """
    if job and campaign is None:
        raise UsageError("--job is that of a campaign: add --campaign FILE")
    if campaign is not None:
        from catseye.app.campaign.load import load_campaign

        # A fault of the file is named before the screen is taken over.
        load_campaign(campaign)
    from catseye.app.tui.start import show

    show(cell, runs_folder(runs), speed, campaign, job)
