"""Wall time of a slice of the paper's plan at real speed, against motion, settling and dwell.

The motion is what the emulated bench saw: from the start of each of its movements to its end, in bench time, which is
real time here. Nothing of the program's own account enters.
"""

from datetime import datetime
from pathlib import Path

from catseye.app.engine.request import RunOutcome
from catseye.app.store.reader import RunReader
from tests.benchmarks.test_time_per_point import FEW_NODES, measured_slice, searched
from tests.system.command import Emulated, emulated

SETTLE_S = DWELL_S = 0.5
MOST = 1.05


def motion_s(bench: Emulated, since_s: float) -> float:
    """Return how long the arm moved since a bench time, s."""
    total_s, started_s = 0.0, None
    for entry in bench.ask(op="log", device="robot")["entries"]:
        if entry["kind"] != "motion" or entry["time_s"] < since_s:
            continue
        if entry["text"].startswith("motion to"):
            started_s = entry["time_s"]
        elif entry["text"].startswith("arrival at") and started_s is not None:
            total_s += entry["time_s"] - started_s
            started_s = None
    return total_s


def wall_s(outcome: RunOutcome) -> tuple[float, int]:
    """Return the time from the beginning of the first step to the end of the last, s, and the number of distances."""
    reader = RunReader(outcome.path)
    steps = reader.steps()
    start, end = (datetime.fromisoformat(text) for text in (steps[0].started_utc, steps[-1].done_utc))
    return (end - start).total_seconds(), reader.count("points") + len(reader.records("closure"))


async def test_wall_time_of_a_slice(tmp_path: Path) -> None:
    with emulated(tmp_path, edit=FEW_NODES) as bench:
        since_s = await searched(bench, tmp_path / "runs")
        outcome = await measured_slice(bench, tmp_path / "runs")
        moving_s = motion_s(bench, since_s)
    assert outcome.exit_code == 0
    taken_s, distances = wall_s(outcome)
    ratio = taken_s / (moving_s + distances * (SETTLE_S + DWELL_S))
    figure = f"wall time of {distances} distances at real speed: {taken_s:.2f} s, motion {moving_s:.2f} s"
    print(f"\n{figure}, settling and dwell {distances} s, ratio {ratio:.3f} (limit {MOST})")  # noqa: T201  # the figure
    assert distances >= 24
    assert moving_s > 2.0
    assert 1.0 < ratio <= MOST
