"""attach: watch a run that is under way, or steer it."""

import asyncio
import sys
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson, Runs
from catseye.app.store.runs_folder import runs_folder


def attach(
    run: Annotated[
        str | None,
        typer.Argument(
            metavar="[RUN]",
            help="path, name, start of the name, or id [the only one under way]",
            autocompletion=completion.stored_runs,
        ),
    ] = None,
    control: Annotated[
        bool, typer.Option("--control", help="control the run and answer its questions")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="take control from whoever has it")] = False,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Watch or control a run under way. Ends with the run's exit code.

    Ctrl-C leaves the run; with --control it holds the run, and a second Ctrl-C stops it. If the terminal dies while
    it has control, the run is held, or treated as [engine] on_client_lost in the cell file says. This is not an
    emergency stop.

    Example: catseye attach 1a2b3c --control
    """
    followed = _follow(run, runs_folder(runs), control=control or force, force=force, as_json=as_json)
    sys.exit(int(asyncio.run(followed)))


async def _follow(run: str | None, root: Path, *, control: bool, force: bool, as_json: bool) -> int:
    from catseye.app.cli.attached import PROGRAM, People, Programs, only_engine, socket_of
    from catseye.app.service.client import connect
    from catseye.app.store.catalog import resolve_run

    path = await only_engine(root) if run is None else socket_of(resolve_run(root, run))
    async with connect(path, PROGRAM) as client:
        if control:
            await client.take_control(force=force)
        front = Programs(client, control=control) if as_json else People(client, control=control)
        return await front.follow()
