"""What a job has still to do, and how long that took the last time."""

from pathlib import Path

from catseye.app.campaign.forecast import (
    Expected,
    LastTime,
    Rest,
    forecast,
    last_times,
    rest_of,
    took_bench_s,
)
from catseye.app.campaign.model import StageEntry
from catseye.app.protocol.campaign_events import StageStarted
from catseye.app.protocol.procedures import procedures
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.stages import CellStage, State
from catseye.app.results.readiness.survey import Survey
from catseye.app.store.reader import Status
from catseye.app.store.run_store import RunStore
from tests.unit.app.campaign.night import Effect, Night
from tests.unit.app.engine.fakes import ManualClock

ENTRIES = [StageEntry(name=name) for name in ("warmup", "reflector-search", "open-loop", "identify")]
TIMES = {"warmup": LastTime("w", 600.0), "open-loop": LastTime("o", 90.0)}


def run(name: str, status: Status = "complete") -> CellRun:
    return CellRun(f"20260102T030405Z_{name}_abcdef", name, status, 60.0, resumable=False)


def expected(*done: str) -> list[Expected]:
    """Return the forecast of a way of which some stages are done."""
    stages = [
        CellStage(entry.name, entry.name != "identify", _state(entry.name in done), "", "")
        for entry in ENTRIES
    ]
    survey = Survey("lab-1", procedures(), {}, CellRuns([]), stages)
    return forecast(ENTRIES, survey, lambda _entry, stage: stage is not None and stage.state == "done", TIMES)


def _state(done: bool) -> State:
    return "done" if done else "later"


def held(found: list[Expected]) -> list[str]:
    return [one.stage for one in found if one.holds]


def test_what_is_left_takes_as_long_as_the_last_time() -> None:
    found = expected("warmup", "reflector-search")
    assert found == [
        Expected("warmup", True, 600.0, "w"),
        Expected("reflector-search", True),
        Expected("open-loop", False, 90.0, "o"),
        Expected("identify", False),
    ]
    assert rest_of(found[2:]) == Rest(90.0, 90.0, ("identify",))
    assert rest_of(found[3:]) == Rest(None, None, ("identify",))


def test_what_counts_after_a_stage_done_anew_is_done_anew() -> None:
    """Open-loop counts after the search of the reflectors alone, and its model was made from it."""
    assert held(expected("warmup", "open-loop", "identify")) == ["warmup"]


def test_a_procedure_of_its_own_holds_beside_others() -> None:
    assert held(expected("reflector-search", "open-loop", "identify")) == ["reflector-search", "open-loop"]


def test_the_last_time_is_of_the_newest_complete_run() -> None:
    runs = CellRuns([run("open-loop"), run("warmup"), run("open-loop", "stopped")])
    found = last_times(("warmup", "open-loop", "validate"), runs, lambda _name: 800.0, speed=400.0)
    assert found == {
        "warmup": LastTime("20260102T030405Z_warmup_abcdef", 2.0),
        "open-loop": LastTime("20260102T030405Z_open-loop_abcdef", 2.0),
    }


async def test_a_job_says_how_long_the_rest_takes(tmp_path: Path) -> None:
    night = Night(tmp_path, last_times={"search": LastTime("s", 3600.0)})
    night.effects["search"] = [Effect(code=6)]
    loaded = night.campaign({"name": "search"}, {"name": "identify"})
    for _ in range(2):
        await night.conduct(loaded)
    said = [event for event in night.events if isinstance(event, StageStarted)]
    assert [(one.stage, one.expected_s, one.left_s, one.unknown) for one in said] == [
        ("search", 3600.0, 3600.0, ("identify",)),
        ("search", 3600.0, 3600.0, ("identify",)),
        ("identify", None, None, ("identify",)),
    ]


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
