"""The `catseye` command and its emulators as processes of their own."""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.cell.template import TEMPLATE

SPEED = "400"
_PORTS = {"robot": "10001", "interferometer": "10002", "environment": "10502", "control": "10099"}
_LIMIT_S = 110


def catseye(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the command to its end."""
    return subprocess.run(
        [sys.executable, "-m", "app", *map(str, arguments)],
        cwd=cwd,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=_LIMIT_S,
        check=False,
    )


def start(*arguments: str | Path, cwd: Path) -> subprocess.Popen[str]:
    """Start the command; the caller ends it."""
    return subprocess.Popen(
        [sys.executable, "-m", "app", *map(str, arguments)],
        cwd=cwd,
        env=environment(),
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
    process: subprocess.Popen[str]

    def ask(self, **request: object) -> dict[str, Any]:
        """Put a request to the control port."""
        with socket.create_connection(self.control, timeout=10) as connection:
            connection.sendall(json.dumps(request).encode() + b"\n")
            answer: dict[str, Any] = json.loads(connection.makefile("rb").readline())
        assert answer["ok"], answer
        return answer


@contextmanager
def emulated(folder: Path, *options: str, edit: dict[str, str] | None = None) -> Iterator[Emulated]:
    """Emulate the template's bench, edited, on free ports."""
    text = TEMPLATE
    for old, new in (edit or {}).items():
        assert old in text, old
        text = text.replace(old, new)
    free = folder / "emulator.toml"
    free.write_text(_with_ports(text, dict.fromkeys(_PORTS, "0")), encoding="utf-8")
    process = start("emulate", free, "--speed", SPEED, *options, cwd=folder)
    try:
        assert process.stdout is not None
        served = [json.loads(process.stdout.readline()) for _ in _PORTS]
        ports = {row["device"]: row["endpoint"].rpartition(":")[2] for row in served}
        cell = folder / "cell.toml"
        cell.write_text(_with_ports(text, ports), encoding="utf-8")
        yield Emulated(cell, ("127.0.0.1", int(ports["control"])), process)
    finally:
        process.terminate()
        process.communicate(timeout=10)


def _with_ports(text: str, ports: dict[str, str]) -> str:
    for device, number in _PORTS.items():
        text = text.replace(f"127.0.0.1:{number}", f"127.0.0.1:{ports[device]}")
    return text


def last_run(folder: Path, procedure: str) -> str:
    """Return the name of the newest run of a procedure."""
    listed = catseye("runs", "--json", cwd=folder)
    rows = [json.loads(line) for line in listed.stdout.splitlines()]
    return [str(row["run"]) for row in rows if row["procedure"] == procedure][-1]
