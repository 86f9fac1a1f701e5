"""engine: a process that runs procedures for its clients and outlives them."""

import asyncio
import os
import sys
from contextlib import suppress
from typing import Annotated

import typer

from catseye.app.cli.options import CellOption, Metrics, Runs
from catseye.app.store.runs_folder import runs_folder


def engine(
    cell: CellOption,
    wait_for_client: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="S", help="end after this idle time without any client, s [never]"),
    ] = None,
    once: Annotated[
        bool, typer.Option("--once", hidden=True, help="do what a line of stdin asks for")
    ] = False,
    runs: Runs = None,
    metrics: Metrics = None,
) -> None:
    """Start an engine for clients to use. It waits for a client to start a procedure, and outlives clients.

    When ready, it prints the path of its socket; docs/engine.md describes the messages.

    Example: catseye engine --cell cell.toml
    """
    from catseye.app.cli.detached_engine import run_once, serve
    from catseye.app.cli.outlet import patient_output
    from catseye.app.service.metrics import require_metrics_file

    require_metrics_file(metrics, cell)
    # Out of the terminal's session, where that is possible: the engine outlives the terminal.
    with suppress(PermissionError):
        os.setsid()
    root = runs_folder(runs)
    with patient_output():
        served = run_once(cell, root, metrics) if once else serve(cell, root, wait_for_client, metrics)
        code = asyncio.run(served)
    sys.exit(int(code))
