"""Where the engine listens that a command is to join."""

from pathlib import Path

from catseye.app.cli.attached import PROGRAM
from catseye.app.errors import UsageError
from catseye.app.service.address import all_sockets, find_socket
from catseye.app.service.client import connect
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.store.reader import Accept, RunReader


def socket_of(run: Path) -> Path:
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


async def only_engine() -> Path:
    """Return the socket of the only engine that runs.

    Raises:
        UsageError: there is none, or several.
    """
    found: dict[str, Path] = {}
    for path in all_sockets():
        try:
            async with connect(path, PROGRAM) as client:
                found[str(client.snapshot.path or client.snapshot.runs)] = path
        except (ServiceError, RefusedError):
            continue
    if len(found) == 1:
        return next(iter(found.values()))
    if not found:
        raise UsageError("no engine is running: start a run with: catseye run")
    raise UsageError(f"several engines are running: name one of {', '.join(found)}")
