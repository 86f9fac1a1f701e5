"""Runs that are killed, stopped or blocked while the emulated arm moves, and what the controller saw of it."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.patience import HANG_S
from tests.system.command import Emulated, catseye, environment

MOTIONS = ("EXEC2", "EXECMOV", "JOG", "RUN")


@dataclass
class Program:
    """A `catseye` of its own.

    Attributes:
        bench: what it works on.
        process: of the program.
    """

    bench: Emulated
    process: "subprocess.Popen[str]"

    def until_moving(self) -> None:
        """Wait until the arm moves."""
        until(lambda: self.moving or self.process.poll() is not None)
        assert self.process.poll() is None, self.process.communicate()[1]

    @property
    def moving(self) -> bool:
        return bool(self.bench.ask(op="state")["moving"])

    def send(self, number: int) -> None:
        os.kill(self.process.pid, number)

    def ended(self) -> tuple[int, str]:
        """Return exit code and stderr."""
        _, stderr = self.process.communicate(timeout=HANG_S)
        return self.process.returncode, stderr


def until(holds: Callable[[], bool]) -> None:
    """Wait until something holds."""
    end_s = time.monotonic() + HANG_S
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.01)


@contextmanager
def program(
    bench: Emulated, *arguments: str | Path, module: str = "catseye", **pipes: Any
) -> Iterator[Program]:
    """Start a program; it is killed at the end, if it still runs then."""
    process = subprocess.Popen(
        [sys.executable, "-m", module, *map(str, arguments)],
        cwd=bench.cell.parent,
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        **pipes,
    )
    try:
        yield Program(bench, process)
    finally:
        # A guard may still say STOP for a moment; its lock is free when it is done.
        with suppress(ProcessLookupError):
            process.send_signal(signal.SIGCONT)
        process.kill()
        process.communicate(timeout=HANG_S)
        until(lambda: not guards_of(process.pid))


@contextmanager
def measuring(bench: Emulated, module: str = "catseye", search: str | Path = "none") -> Iterator[Program]:
    """Start a measurement in real time; without a search it moves, but finds no beam at its first point."""
    words: list[str | Path] = ["run", "open-loop", "--cell", bench.cell, "--search", search, "--json"]
    with program(bench, *words, module=module) as made:
        yield made


def guards_of(pid: int) -> list[int]:
    """Return the guard processes of a program, also after its death."""
    found = []
    for folder in Path("/proc").iterdir():
        with suppress(OSError):
            if folder.name.isdecimal() and str(pid) in _guarded(folder):
                found.append(int(folder.name))
    return found


def _guarded(folder: Path) -> list[str]:
    words = (folder / "cmdline").read_bytes().split(b"\0")
    return [words[-2].decode()] if len(words) > 4 and words[-4].endswith(b"guard.py") else []


def requests(bench: Emulated) -> list[tuple[float, str]]:
    """Return bench times and texts of the requests to the controller."""
    entries: list[dict[str, Any]] = bench.ask(op="log", device="robot")["entries"]
    return [(e["time_s"], e["text"].rpartition(";")[2]) for e in entries if e["kind"] == "request"]


def words_after_first_stop(bench: Emulated, since_s: float) -> list[str]:
    """Return the requests to the controller from the first STOP on."""
    words = [text for time_s, text in requests(bench) if time_s > since_s]
    assert "STOP" in words, words
    return words[words.index("STOP") :]


def moved(words: list[str]) -> list[str]:
    """Return those that begin a motion."""
    return [word for word in words if word.startswith(MOTIONS)]


def newest_end(bench: Emulated) -> dict[str, Any]:
    """Return what the newest run says about its end."""
    runs = sorted((bench.cell.parent / "catseye-runs").glob("*_open-loop_*"))
    shown = catseye("show", runs[-1].name, "--json", cwd=bench.cell.parent)
    document: dict[str, Any] = json.loads(shown.stdout)
    return document
