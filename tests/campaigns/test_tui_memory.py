"""Eight hours of bench time with the user interface open: its memory and the engine's stay flat."""

import contextlib
import time
from pathlib import Path

import numpy as np
import pytest

from catseye.app.service.address import find_socket
from tests.system.command import emulated, own_runtime
from tests.system.memory import resident_mb
from tests.system.screen import Screen, on_screen
from tests.system.socket_client import Lines

SPEED = 400.0
BENCH_H = 8.0
WARM_SHARE = 0.3
"""Share of the time in which caches fill."""

GROWTH_MB = 8.0
"""Bounded logs, points and traffic fill up meanwhile: some MB, whatever the hours."""


@pytest.mark.timeout(400)
def test_memory_is_flat_over_eight_hours_of_bench_time(tmp_path: Path) -> None:
    with (
        own_runtime(),
        emulated(tmp_path, "--speed", str(SPEED)) as bench,
        on_screen("tui", "--cell", bench.cell, "--speed", str(SPEED), cwd=tmp_path, size=(120, 40)) as screen,
    ):
        screen.shows("IDLE", "interferometer")
        engine = _started(tmp_path)
        screen.press("f4")
        screen.shows("EXECUTE")
        grown_mb = _grown_mb(screen, {"interface": screen.process.pid, "engine": engine})
        screen.press("f12")
        screen.shows("stopped")
    for name, megabytes in grown_mb.items():
        hours = BENCH_H * (1 - WARM_SHARE)
        print(f"\n{name}: {megabytes:+.1f} MB over {hours:.1f} h of bench time")  # noqa: T201  # the figure
        assert megabytes <= GROWTH_MB, name


def _started(folder: Path) -> int:
    """Start a procedure that takes longer than the test; return the engine's process."""
    path = find_socket(folder / "catseye-runs")
    assert path is not None
    with contextlib.closing(Lines(str(path))) as client:
        snapshot = client.ask("hello", client="test", who="test")["snapshot"]
        client.ask("control")
        params = {"cycles": 1000}
        answer = client.ask("start", procedure="repeatability", params=params, search="none", speed=SPEED)
        assert answer["ok"], answer
        client.ask("release")
        return int(snapshot["pid"])


def _grown_mb(screen: Screen, processes: dict[str, int]) -> dict[str, float]:
    """Watch the screen for the hours; return by how much each process grew after its caches had filled, MB."""
    start_s, length_s = time.monotonic(), 3600.0 * BENCH_H / SPEED
    seen: dict[str, list[tuple[float, float]]] = {name: [] for name in processes}
    while (share := (time.monotonic() - start_s) / length_s) < 1.0:
        # Both screens with something that moves on them.
        screen.press("f2" if int(share * 20) % 2 else "f4")
        text = screen.shows("EXECUTE")
        assert text
        time.sleep(0.5)
        for name, pid in processes.items():
            if share >= WARM_SHARE:
                seen[name].append((share, resident_mb(pid)))
    return {name: _rise(np.array(values)) for name, values in seen.items()}


def _rise(values: "np.ndarray[tuple[int, int], np.dtype[np.float64]]") -> float:
    """Return the rise of a straight line through all samples, from the first to the last."""
    slope = np.polyfit(values[:, 0], values[:, 1], 1)[0]
    return float(slope * (values[-1, 0] - values[0, 0]))
