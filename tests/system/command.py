"""The `catseye` command and its emulators as processes of their own."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.guard.lock import lock_path
from catseye.app.service.emulation import emulated_devices
from catseye.drivers.links.endpoint import SerialEndpoint, TcpEndpoint, parse_endpoint
from tests.machine_lines import faults_of
from tests.patience import HANG_S
from tests.system import forked

SPEED = "400"


def catseye(*arguments: str | Path, cwd: Path, crash: str = "") -> subprocess.CompletedProcess[str]:
    """Run the command to its end, or to a crash point at which it dies."""
    env = {**environment(), "CATSEYE_CRASHPOINT": crash}
    done = forked.run("catseye", arguments, cwd=cwd, env=env, limit_s=HANG_S)
    assert "--json" not in arguments or not (faults := faults_of(done.stdout)), faults
    return done


@contextmanager
def begun(*arguments: str | Path, cwd: Path) -> Iterator[tuple[forked.Forked, IO[str]]]:
    """Begin the command and yield it with its stdout; it is killed at the end, if it still runs then."""
    with (
        tempfile.TemporaryFile() as said,
        forked.talking("catseye", arguments, cwd=cwd, env=environment(), err=said) as talking,
    ):
        yield talking


def start(
    *arguments: str | Path, cwd: Path, module: str = "catseye", crash: str = ""
) -> subprocess.Popen[str]:
    """Start the command, or another module, which may die at a crash point; the caller ends it."""
    return subprocess.Popen(
        [sys.executable, "-m", module, *map(str, arguments)],
        cwd=cwd,
        env={**environment(), "CATSEYE_CRASHPOINT": crash},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def environment() -> dict[str, str]:
    """Return the environment of the command: this checkout, and one thread for arrays."""
    root = str(Path(__file__).parents[2])
    return {**os.environ, "PYTHONPATH": root, "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Emulated:
    """A running emulator with the cell file that leads to it.

    Attributes:
        cell: cell file with the real ports.
        control: host and port of the control port.
        process: the emulator.
    """

    cell: Path
    control: tuple[str, int]
    process: forked.Forked

    def ask(self, **request: object) -> dict[str, Any]:
        """Put a request to the control port."""
        return ask_bench(self.control, **request)


def ask_bench(control: tuple[str, int], **request: object) -> dict[str, Any]:
    """Put a request to a control port."""
    with socket.create_connection(control, timeout=HANG_S) as connection:
        connection.sendall(json.dumps(request).encode() + b"\n")
        answer: dict[str, Any] = json.loads(connection.makefile("rb").readline())
    assert answer["ok"], answer
    return answer


@contextmanager
def own_runtime() -> Iterator[None]:
    """Have engines and clients meet in a folder of their own; a socket's path must be short."""
    with tempfile.TemporaryDirectory(dir="/tmp") as runtime, pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", runtime)
        yield


@contextmanager
def emulated(
    folder: Path,
    *options: str,
    edit: dict[str, str] | None = None,
    text: str = TEMPLATE,
    module: str = "catseye",
) -> Iterator[Emulated]:
    """Emulate the bench of a cell file, edited, on free ports; serial lines as the file has them."""
    for old, new in (edit or {}).items():
        assert old in text, old
        text = text.replace(old, new)
    cell = folder / "cell.toml"
    cell.write_text(text, encoding="utf-8")
    asked = _endpoints(cell)
    free = folder / "emulator.toml"
    free.write_text(re.sub(r"(://127\.0\.0\.1):\d+", r"\1:0", text), encoding="utf-8")
    words: list[str | Path] = ["emulate", free, "--speed", SPEED, *options]
    with (
        (folder / "emulator.txt").open("wb") as said,
        forked.talking(module, words, cwd=folder, env=environment(), err=said) as (process, lines),
    ):
        served = [json.loads(lines.readline())["endpoint"] for _ in asked]
        for old, new in zip(asked, served, strict=True):
            text = text.replace(f'"{old}"', f'"{new}"')
        cell.write_text(text, encoding="utf-8")
        try:
            yield Emulated(cell, ("127.0.0.1", int(served[-1].rpartition(":")[2])), process)
        finally:
            # As long as the port is taken nobody else has an arm there.
            for endpoint in served:
                forget_stops(endpoint)
            process.send_signal(signal.SIGTERM)
            process.wait(HANG_S)


def forget_stops(endpoint: str) -> None:
    """Remove what guards have left for the next owner of an arm that exists no longer."""
    match parse_endpoint(endpoint):
        case TcpEndpoint(_, port):
            lock_path(f"loopback:{port}").unlink(missing_ok=True)
        case SerialEndpoint(device):
            lock_path(os.path.realpath(device)).unlink(missing_ok=True)


def only(reflector: str) -> dict[str, str]:
    """Return the edit of the template that leaves one reflector."""
    tables = re.findall(r"\[\[reflector\]\].*\n(?:.+\n)+\n", TEMPLATE)
    return {table: "" for table in tables if f'"{reflector}"' not in table}


def _endpoints(cell: Path) -> list[str]:
    """Return the endpoints of a cell's devices in the order in which the emulator lists them."""
    loaded = load_cell(cell).cell
    assert loaded.tracker is not None
    control = loaded.tracker.control or loaded.tracker.endpoint
    return [*(device.endpoint for device in emulated_devices(loaded)), control]


def last_run(folder: Path, procedure: str) -> str:
    """Return the name of the newest run of a procedure."""
    listed = catseye("runs", "--json", cwd=folder)
    rows = [json.loads(line) for line in listed.stdout.splitlines()]
    return [str(row["run"]) for row in rows if row["procedure"] == procedure][-1]
