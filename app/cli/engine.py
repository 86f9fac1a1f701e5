"""engine: a process that runs procedures for its clients and outlives them."""

import asyncio
import os
import sys
from contextlib import suppress
from typing import Annotated

import typer

from catseye.app.cli.options import CellOption, Runs
from catseye.app.store.runs_folder import runs_folder


def engine(
    cell: CellOption,
    wait_for_client: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="S", help="idle without any client for so long, s, it ends [never]"),
    ] = None,
    once: Annotated[
        bool, typer.Option("--once", hidden=True, help="do what a line of stdin asks for")
    ] = False,
    runs: Runs = None,
) -> None:
    """Run an engine of its own process: idle until a client starts a procedure, it outlives clients and terminal.

    It writes its socket to stdout when it is ready; docs/engine.md describes the messages.

    Example: catseye engine --cell cell.toml
    """
    from catseye.app.cli.detached_engine import run_once, serve

    # Out of the terminal's session, where that is possible: the engine outlives the terminal.
    with suppress(PermissionError):
        os.setsid()
    root = runs_folder(runs)
    served = run_once(cell, root) if once else serve(cell, root, wait_for_client)
    sys.exit(int(asyncio.run(served)))
