"""Modules in processes of their own that need not import the program: one that has imported it forks them off.

Each has its own memory, folder, environment, streams, signals and exit code, and saves most of a second of CPU time.
Where the start or what interrupts it is the point, `command.start` takes the interpreter.
"""

import gc
import multiprocessing
import os
import runpy
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any

from catseye import procedures, simulators
from catseye.app import cli
from tests.patience import HANG_S
from tests.system.command_imports import imported_by, modules_below

_CONTEXT = multiprocessing.get_context("forkserver")
_CONTEXT.set_forkserver_preload(
    [
        *dict.fromkeys(name for module in modules_below(cli) for name in (module, *imported_by(module))),
        *(name for package in (procedures, simulators) for name in modules_below(package)),
    ]
)


class Forked:
    """A module that runs as `python -m` would run it.

    Args:
        module: which.
        arguments: of its command line.
        cwd: where it runs.
        env: its environment.
        out: its stdout.
        err: its stderr.
    """

    def __init__(
        self,
        module: str,
        arguments: Sequence[str | Path],
        *,
        cwd: Path,
        env: Mapping[str, str],
        out: IO[Any],
        err: IO[Any],
    ) -> None:
        words = [module, *map(str, arguments)]
        # Descriptors travel to another process as connections do.
        with (
            Connection(os.dup(out.fileno()), readable=False) as stdout,
            Connection(os.dup(err.fileno()), readable=False) as stderr,
        ):
            self._process = _CONTEXT.Process(target=_become, args=(words, cwd, dict(env), stdout, stderr))
            self._process.start()

    @property
    def pid(self) -> int:
        """Its number."""
        assert self._process.pid is not None
        return self._process.pid

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        # It may end between the question and the signal.
        if self._process.exitcode is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        """Send SIGKILL."""
        self.send_signal(signal.SIGKILL)

    def wait(self, limit_s: float) -> int:
        """Wait for its end and return its exit code, negative for a signal; one that takes longer is killed."""
        self._process.join(limit_s)
        if self._process.exitcode is None:
            self.kill()
            self._process.join()
            raise subprocess.TimeoutExpired(self._process.name, limit_s)
        return self._process.exitcode


@contextmanager
def talking(
    module: str, arguments: Sequence[str | Path], *, cwd: Path, env: Mapping[str, str], err: IO[Any]
) -> Iterator[tuple[Forked, IO[str]]]:
    """Run a module and yield it with its stdout; it is killed at the end, if it still runs then."""
    source, sink = os.pipe()
    with open(source, encoding="utf-8") as lines:
        with open(sink, "wb") as out:
            process = Forked(module, arguments, cwd=cwd, env=env, out=out, err=err)
        try:
            yield process, lines
        finally:
            process.kill()
            process.wait(HANG_S)


def run(
    module: str, arguments: Sequence[str | Path], *, cwd: Path, env: Mapping[str, str], limit_s: float
) -> "subprocess.CompletedProcess[str]":
    """Run a module to its end."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        code = Forked(module, arguments, cwd=cwd, env=env, out=out, err=err).wait(limit_s)
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess([*arguments], code, out.read().decode(), err.read().decode())


def _become(words: list[str], cwd: Path, env: dict[str, str], stdout: Connection, stderr: Connection) -> None:
    # The garbage collector need not walk through what was imported: that would take as long as a time-out.
    gc.freeze()
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(env)
    os.dup2(stdout.fileno(), 1)
    os.dup2(stderr.fileno(), 2)
    sys.argv = words
    runpy.run_module(words[0], run_name="__main__", alter_sys=True)
