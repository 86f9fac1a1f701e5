"""Where the engines of a folder of runs listen, and the last way to one that does not answer."""

import os
import signal
from contextlib import suppress
from pathlib import Path

from catseye.app.service.address import all_sockets, find_socket, is_live, socket_name


def find_engine(root: Path) -> Path | None:
    """Return the socket of the newest run under way, else of the engine of a folder; None when nobody listens."""
    return next(iter(all_engines(root)), None)


def all_engines(root: Path) -> list[Path]:
    """Return the sockets that somebody listens at: of runs, the newest first, then of the folder."""
    folder = find_socket(root)
    # A process that was killed leaves its socket behind.
    return [*engines_of_runs(root), *([folder] if folder is not None and is_live(folder) else [])]


def engines_of_runs(root: Path) -> list[Path]:
    """Return the sockets of runs under way, the newest run first, whichever process they are in."""
    from catseye.app.store.run_names import run_name

    sockets = {path.name: path for path in all_sockets()}
    if not sockets or not root.is_dir():
        return []
    names = sorted((path.name for path in root.iterdir() if run_name(path.name)), reverse=True)
    found = (sockets.get(socket_name(root / name)) for name in names)
    return [path for path in found if path is not None and is_live(path)]


class EngineProcess:
    """The process of an engine; it stays that process when its number is given to another one."""

    def __init__(self, pid: object) -> None:
        self._descriptor: int | None = None
        if isinstance(pid, int) and pid > 0 and pid != os.getpid():
            with suppress(OSError):
                self._descriptor = os.pidfd_open(pid)

    def abort(self) -> bool:
        """Send it the signal that aborts what it does and ends it, past its socket; return False when it is gone."""
        if self._descriptor is None:
            return False
        try:
            signal.pidfd_send_signal(self._descriptor, signal.SIGTERM)
            # One that was halted takes no signal before it goes on.
            signal.pidfd_send_signal(self._descriptor, signal.SIGCONT)
        except OSError:
            return False
        return True

    def forget(self) -> None:
        """Let it go."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None
