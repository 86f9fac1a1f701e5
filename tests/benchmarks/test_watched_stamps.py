"""A watched run reads when an unwatched one does: stamps of the readings of a dwell, point by point with and without.

One run at real speed on the emulators; a client watches bench and traffic during every other point. The arrival of
each reading is held against the moment at which it was due.
"""

import asyncio
import json
import tempfile
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.service.client import EngineClient, connect
from tests.benchmarks.test_time_per_point import FEW_NODES, searched
from tests.system.command import emulated, start

READINGS = 100
DWELL_S = 0.5
LIMIT_MS = 0.5
_EDIT = {**FEW_NODES, "readings = 10 ": f"readings = {READINGS} "}

Stamps = dict[bool, list[float]]


async def measured(client: EngineClient) -> tuple[Path, dict[str, bool]]:
    """Measure; return the run and, by the time at which a point was begun, whether it was watched."""
    watched: dict[str, bool] = {}
    looking = False
    opened = await client.request("start", procedure="open-loop", params={"reflectors": ["P2"]})
    async for event in client.events():
        if event["event"] == "step-started":
            looking = not looking
            for topic in ("watch", "traffic"):
                await client.request(topic, on=looking)
        elif event["event"] == "point":
            point: Any = event["point"]
            watched[str(point["time_utc"])] = looking
        elif event["event"] == "run-ended":
            assert event["exit_code"] == 0, event
            return Path(str(opened["path"])), watched
    raise AssertionError("the engine is gone")


def lateness_ms(run: Path, watched: dict[str, bool]) -> Stamps:
    """Return how late each reading of each dwell came, ms, by whether its point was watched."""
    arrivals = [
        datetime.fromisoformat(line["t"])
        for line in map(json.loads, (run / "wire.log").read_text().splitlines())
        if line["device"] == "interferometer" and line["direction"] == "rx"
    ]
    found: Stamps = {False: [], True: []}
    for time_utc, is_watched in watched.items():
        begun = datetime.fromisoformat(time_utc)
        readings = [arrival for arrival in arrivals if arrival >= begun][:READINGS]
        for number, arrival in enumerate(readings):
            due = begun + timedelta(seconds=number * DWELL_S / (READINGS - 1))
            found[is_watched].append((arrival - due) / timedelta(milliseconds=1))
    return found


@pytest.mark.timeout(300)
async def test_a_watcher_delays_no_reading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with tempfile.TemporaryDirectory(dir="/tmp") as runtime, emulated(tmp_path, edit=_EDIT) as bench:
        monkeypatch.setenv("XDG_RUNTIME_DIR", runtime)
        await searched(bench, tmp_path / "catseye-runs")
        engine = start("engine", "--cell", bench.cell, cwd=tmp_path)
        try:
            assert engine.stdout is not None
            ready = json.loads(await asyncio.to_thread(engine.stdout.readline))
            async with connect(Path(ready["socket"]), "test", "Ada") as client:
                await client.take_control()
                run, watched = await measured(client)
        finally:
            engine.terminate()
            engine.communicate(timeout=20)
    late_ms = lateness_ms(run, watched)
    plain, seen = (np.reshape(late_ms[is_watched], (-1, READINGS)) for is_watched in (False, True))
    (plain50, plain99), (seen50, seen99) = np.percentile(plain, [50, 99]), np.percentile(seen, [50, 99])
    # A burst of somebody else's work falls into one point; what a watcher costs falls into each of his.
    typical_ms = np.median(np.percentile(seen, 99, axis=1)) - np.median(np.percentile(plain, 99, axis=1))
    print(  # noqa: T201  # the figure
        f"\nreadings after they were due: unwatched p50 {plain50:.3f} p99 {plain99:.3f} ms of {plain.size}, watched "
        f"p50 {seen50:.3f} p99 {seen99:.3f} ms of {seen.size}: p99 differs by {seen99 - plain99:+.3f} ms, that of a "
        f"typical point by {typical_ms:+.3f} ms (limit {LIMIT_MS} ms)"
    )
    assert min(len(plain), len(seen)) >= 10
    assert typical_ms <= LIMIT_MS
