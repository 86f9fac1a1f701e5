"""Our charts against textual-plot's: time to the first screen, CPU while 1000 values a second are drawn, look.

Both draw in turn, in the same minutes: other work on the machine meets both.
"""

import fcntl
import json
import os
import pty
import select
import statistics
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

from tests.patience import HANG_S

ROUNDS = 3
SECONDS = 10.0
KINDS = ("ours", "peer", "none")

Figures = dict[str, float]


def test_live_trace_and_map_cost_half_of_textual_plot(tmp_path: Path) -> None:
    """Two pictures, ours.svg and peer.svg, stay in the folder that is printed."""
    pytest.importorskip("textual_plot", reason="make bench installs it")
    seen: dict[str, list[Figures]] = {kind: [] for kind in KINDS}
    for _ in range(ROUNDS):
        for kind in KINDS:
            seen[kind].append(drawn(kind, tmp_path / kind))
    middle = {kind: medians(rounds) for kind, rounds in seen.items()}
    for kind, one in middle.items():
        write(
            f"{kind}: first screen {one['first_s']:.2f} s ({one['first_cpu_s']:.2f} s of CPU), "
            f"{100.0 * one['cpu_share']:.1f} % CPU, loop late p99 {one['late_p99_ms']:.1f} ms, "
            f"largest {one['late_max_ms']:.0f} ms, {1e-3 * one['bytes'] / SECONDS:.0f} kB/s to the terminal"
        )
    write(f"pictures: {tmp_path}")
    ours, peer = (middle[kind]["cpu_share"] - middle["none"]["cpu_share"] for kind in ("ours", "peer"))
    assert ours < 0.5 * peer
    assert middle["ours"]["first_cpu_s"] < 1.2 * middle["peer"]["first_cpu_s"]


def medians(rounds: list[Figures]) -> Figures:
    return {name: statistics.median(one[name] for one in rounds) for name in rounds[0]}


def drawn(kind: str, output: Path) -> Figures:
    """Let a program draw on a terminal of 120 × 40 cells; return its figures and the bytes that it wrote."""
    descriptor, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
    words = ("tests.benchmarks.chart_peers", kind, str(time.monotonic_ns()), str(SECONDS), str(output))
    with subprocess.Popen(
        [sys.executable, "-m", *words],
        cwd=Path(__file__).parents[2],
        env={**os.environ, "TERM": "xterm-256color", "COLORTERM": "truecolor"},
        stdin=slave,
        stdout=slave,
        stderr=slave,
    ) as program:
        os.close(slave)
        count = taken_in(descriptor, program)
    os.close(descriptor)
    assert program.returncode == 0
    figures: Figures = json.loads(output.with_suffix(".json").read_text(encoding="utf-8"))
    return {**figures, "bytes": float(count)}


def taken_in(descriptor: int, program: subprocess.Popen[bytes]) -> int:
    """Read what a program writes until it ends; return how many bytes."""
    count, end_s = 0, time.monotonic() + SECONDS + HANG_S
    while program.poll() is None:
        assert time.monotonic() < end_s
        if select.select([descriptor], [], [], 0.1)[0]:
            try:
                count += len(os.read(descriptor, 65536))
            except OSError:
                # The terminal is closed: the program is about to end.
                break
    return count


def write(figure: str) -> None:
    print(f"\n{figure}")  # noqa: T201  # the figure is the result of a benchmark
