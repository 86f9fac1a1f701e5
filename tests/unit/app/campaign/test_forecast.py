"""What a job has still to do, and how long that took the last time."""

from pathlib import Path

from catseye.app.campaign.forecast import Expected, forecast, left_bench_s, took_bench_s
from catseye.app.campaign.model import StageEntry
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.stages import CellStage
from catseye.app.store.run_store import RunStore
from tests.unit.app.engine.fakes import ManualClock

ENTRIES = [StageEntry(name=name) for name in ("warmup", "open-loop", "identify", "report")]


def run(name: str, status: str = "complete") -> CellRun:
    return CellRun(f"20260102T030405Z_{name}_abcdef", name, status, 60.0, resumable=False)  # type: ignore[arg-type]  # a state


def stage(name: str, state: str, *, procedure: bool) -> CellStage:
    return CellStage(name, procedure, state, "", "")  # type: ignore[arg-type]  # a state


def test_what_is_left_takes_as_long_as_the_last_time() -> None:
    stages = [
        stage("warmup", "done", procedure=True),
        stage("open-loop", "next", procedure=True),
        stage("identify", "later", procedure=False),
    ]
    runs = CellRuns([run("warmup"), run("open-loop"), run("open-loop", "stopped")])
    found = forecast(ENTRIES, stages, runs, lambda name: 600.0 if "warmup" in name else 90.0)
    assert found == [
        Expected("warmup", True, 600.0, "20260102T030405Z_warmup_abcdef"),
        Expected("open-loop", False, 90.0, "20260102T030405Z_open-loop_abcdef"),
        Expected("identify", False),
        Expected("report", False),
    ]
    assert left_bench_s(found) == 90.0


async def test_interruptions_are_no_time_of_a_run(tmp_path: Path) -> None:
    """40 s, an hour of interruption, and 20 s at ten times real speed."""
    clock = ManualClock()
    store = await RunStore.create(tmp_path, "warmup", {"clock_speed": 10.0}, clock, reserve_bytes=0)
    clock.advance(40.0)
    await store.finish("stopped", 4)
    clock.advance(3600.0)
    store = await RunStore.reopen(store.path, clock, reserve_bytes=0)
    clock.advance(20.0)
    await store.finish("complete", 0)
    assert took_bench_s(tmp_path, store.path.name) == 600.0


def test_a_run_that_cannot_be_read_says_nothing(tmp_path: Path) -> None:
    assert took_bench_s(tmp_path, "20260102T030405Z_warmup_abcdef") is None
