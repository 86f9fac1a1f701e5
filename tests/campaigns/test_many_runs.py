"""Many runs in one engine: its memory does not grow with them.

`CATSEYE_MANY_RUNS` sets how many [300].
"""

import contextlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

from tests.system.command import begun, emulated, own_runtime
from tests.system.memory import resident_mb
from tests.system.socket_client import Lines

RUNS = int(os.environ.get("CATSEYE_MANY_RUNS", "300"))
SPEED = 4000.0
WARM_SHARE = 0.2
"""Share of the runs in which caches fill."""

MOST_KB = 20.0
"""Growth a run."""

SHORT = {"reflectors": ["P1"], "poses": 1, "cycles": 2}


@pytest.mark.timeout(60 + 10 * RUNS)
def test_memory_does_not_grow_with_the_number_of_runs(tmp_path: Path) -> None:
    with (
        own_runtime(),
        emulated(tmp_path, "--speed", str(SPEED)) as bench,
        begun("engine", "--cell", bench.cell, cwd=tmp_path) as (process, output),
    ):
        resident = _resident_after_each(process.pid, output.readline())
    counted = np.arange(RUNS)[int(WARM_SHARE * RUNS) :]
    slope_kb = 1024.0 * float(np.polyfit(counted, resident[counted], 1)[0])
    print(f"\n{RUNS} runs: {resident[0]:.1f} → {resident[-1]:.1f} MB, {slope_kb:+.1f} kB a run")  # noqa: T201  # the figure
    assert slope_kb <= MOST_KB


def _resident_after_each(pid: int, ready: str) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """Make the runs one after another; return what the engine occupies after each, MB."""
    found = []
    with contextlib.closing(Lines(json.loads(ready)["socket"])) as client:
        client.ask("hello", client="test", who="test")
        client.ask("control")
        for _ in range(RUNS):
            started = client.ask("start", procedure="repeatability", params=SHORT, search="none", speed=SPEED)
            assert started["ok"], started
            ended = client.until(event="run-ended")
            assert ended["status"] == "complete", ended
            client.until(event="idle")
            found.append(resident_mb(pid))
        client.ask("shutdown")
    return np.array(found)
