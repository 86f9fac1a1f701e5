"""attach: watch a run that is under way, or steer it."""

import asyncio
import sys
from pathlib import Path

from catseye.app.cli.attached import PROGRAM, People, Programs
from catseye.app.errors import UsageError
from catseye.app.runs_folder import runs_folder
from catseye.app.service.address import all_sockets, find_socket
from catseye.app.service.client import connect
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import Accept, RunReader


def attach_command(run: str | None, runs: Path | None, *, control: bool, force: bool, as_json: bool) -> None:
    """Join a run and end with its exit code."""
    code = asyncio.run(
        _attach(run, runs_folder(runs), control=control or force, force=force, as_json=as_json)
    )
    sys.exit(int(code))


async def _attach(run: str | None, root: Path, *, control: bool, force: bool, as_json: bool) -> int:
    path = await _only_engine() if run is None else _socket_of(resolve_run(root, run))
    async with connect(path, PROGRAM) as client:
        if control:
            await client.take_control(force=force)
        front = Programs(client, control=control) if as_json else People(client, control=control)
        return await front.follow()


def _socket_of(run: Path) -> Path:
    """Return the socket of a run that is under way.

    Raises:
        UsageError: it is over, or died.
        ServiceError: it is under way and has no socket.
    """
    status = RunReader(run, Accept.UNCHECKED).status
    if status == "complete":
        raise UsageError(f"{run.name} is complete: see it with: catseye show {run.name}")
    if status != "running":
        raise UsageError(
            f"{run.name} is over, its state is {status}: go on with it with: catseye resume {run.name}"
        )
    path = find_socket(run)
    if path is None:
        raise ServiceError(
            f"{run.name} is under way and serves no socket: its log says why; stop it with a signal"
        )
    return path


async def _only_engine() -> Path:
    """Return the socket of the only engine that runs.

    Raises:
        UsageError: there is none, or several.
    """
    found: dict[str, Path] = {}
    for path in all_sockets():
        try:
            async with connect(path, PROGRAM) as client:
                found[str(client.snapshot["path"] or client.snapshot.get("runs"))] = path
        except (ServiceError, RefusedError):
            continue
    if len(found) == 1:
        return next(iter(found.values()))
    if not found:
        raise UsageError("no engine is running: start a run with: catseye run")
    raise UsageError(f"several engines are running: name one of {', '.join(found)}")
