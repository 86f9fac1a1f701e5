"""The next sensible step follows what is stored of a cell, and nothing else."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from app.cell.bench import bench_of
from app.cell.load import load_cell
from app.commands.config import init_command
from app.commands.procedures import procedures_command
from app.guidance.need import links_need
from app.guidance.stages import results_in
from app.guidance.survey import Survey, survey_cell
from app.guidance.words import age_text
from app.store.run_store import RunStore
from procedures.context import Json
from tests.unit.app.engine.fakes import ManualClock

START = datetime(2026, 11, 21, 9, 0, tzinfo=UTC)


class History:
    """A cell's runs, made one an hour."""

    def __init__(self, folder: Path) -> None:
        self.cell, self.root = folder / "cell.toml", folder / "runs"
        init_command(self.cell)
        self.clock = ManualClock()
        self.bench = bench_of(load_cell(self.cell).cell)

    async def put(self, procedure: str, status: str = "complete", cell: str = "lab-1") -> str:
        places: list[Json] = [{"name": r.name, "x_mm": r.x_mm, "y_mm": r.y_mm} for r in self.bench.reflectors]
        meta: dict[str, Json] = {"cell": cell, "configuration": {"reflector": places}}
        store = await RunStore.create(self.root, procedure, meta, self.clock, reserve_bytes=0)
        if procedure == "reflector-search" and status == "complete":
            found: dict[str, Json] = {"reflectors": places, "theta40_deg": 0.0}
            await store.append_step("solve", 1, "solve", found, [])
        await store.finish(status, 0)
        self.clock.advance(3600.0)
        return store.path.name

    def survey(self, later_s: float = 0.0) -> Survey:
        return survey_cell(self.cell, self.root, self.clock.now_utc() + timedelta(seconds=later_s))

    def next(self) -> str:
        stage = self.survey().next
        assert stage is not None
        return stage.name


@pytest.fixture
def history(tmp_path: Path) -> History:
    return History(tmp_path)


async def test_the_way_leads_from_levelling_to_validation(history: History) -> None:
    assert history.next() == "beam-level"
    await history.put("beam-level", cell="lab-2")
    assert history.next() == "beam-level"
    for done, following in (
        ("beam-level", "beam-to-j4"),
        ("beam-to-j4", "reflector-search"),
        ("reflector-search", "warmup"),
        ("warmup", "open-loop"),
    ):
        await history.put(done)
        assert history.next() == following
    measured = await history.put("open-loop")
    assert history.next() == "identify"
    result = {
        "format": "catseye-result/1",
        "model": "error-map",
        "provenance": {"runs": [measured]},
    }
    (history.cell.parent / "map.json").write_text(json.dumps(result))
    assert history.next() == "validation-path"
    await history.put("validation-path")
    stage = history.survey().next
    assert stage is not None
    assert stage.name == "validate"
    assert "map.json" in stage.command


async def test_levelling_again_makes_alignment_next_and_keeps_the_search(history: History) -> None:
    for name in ("beam-level", "beam-to-j4", "reflector-search", "beam-level"):
        await history.put(name)
    assert history.next() == "beam-to-j4"
    states = {stage.name: stage.state for stage in history.survey().stages}
    assert states["reflector-search"] == "done"


async def test_a_warm_arm_cools_down(history: History) -> None:
    for name in ("beam-level", "beam-to-j4", "reflector-search", "warmup"):
        await history.put(name)
    assert history.next() == "open-loop"
    later = history.survey(later_s=4 * 3600.0).next
    assert later is not None
    assert later.name == "warmup"


async def test_a_search_after_which_the_beam_was_moved_is_missing_and_next(history: History) -> None:
    for name in ("beam-level", "reflector-search"):
        await history.put(name)
    clock = history.clock
    store = await RunStore.create(history.root, "beam-to-j4", {"cell": "lab-1"}, clock, reserve_bytes=0)
    await store.event("asked", {"id": "stage/1", "text": "Turn it.", "asked_utc": "now"})
    await store.finish("complete", 0)
    survey = history.survey()
    (need,) = [need for need in survey.needs["open-loop"] if need.what == "search"]
    assert need.met == "missing"
    assert "Search again" in need.text
    assert survey.next is not None
    assert survey.next.name == "reflector-search"


async def test_what_the_cell_cannot_do_is_left_out(history: History) -> None:
    text = history.cell.read_text()
    line = next(line for line in text.splitlines() if line.startswith("j3_range_mm"))
    history.cell.write_text(text.replace(line, ""))
    survey = history.survey()
    assert survey.stages[0].state == "left out"
    assert "j3_range_mm" in survey.stages[0].text
    assert survey.next is not None
    assert survey.next.name == "beam-to-j4"


async def test_last_runs_and_needs_are_told(history: History, capsys: pytest.CaptureFixture[str]) -> None:
    run = await history.put("open-loop", status="stopped")
    procedures_command(history.cell, history.root, as_json=True)
    *procedures, stages = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    (open_loop,) = [each for each in procedures if each["name"] == "open-loop"]
    assert open_loop["last"]["name"] == run
    assert open_loop["last"]["status"] == "stopped"
    assert {need["what"] for need in open_loop["needs"]} >= {"reflectors", "search", "warm arm", "plan"}
    assert stages["cell"] == "lab-1"
    procedures_command(history.cell, history.root, as_json=False)
    out = capsys.readouterr()
    assert "→ beam-level" in out.out
    assert out.err.startswith("next: catseye run beam-level")


def test_lost_devices_are_missing_and_unknown_ones_are_not() -> None:
    assert links_need(None).met == "advised"
    assert links_need([{"name": "robot", "link": "ok"}]).met == "met"
    lost = links_need([{"name": "robot", "link": "lost", "error": "no answer: is it on?"}])
    assert lost.met == "missing"
    assert lost.text == "robot: no answer: is it on?"
    assert links_need([{"name": "robot", "link": "connecting"}]).met == "advised"


def test_only_error_maps_count_as_results(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{")
    (tmp_path / "b.json").write_text('{"format": "catseye-result/1", "model": "conventional"}')
    assert results_in([tmp_path, tmp_path / "none"]) == {}


@pytest.mark.parametrize(
    ("age_s", "text"),
    [(5.0, "just now"), (720.0, "12 min ago"), (5 * 3600.0, "5 h ago"), (3 * 86400.0, "3 d ago")],
)
def test_ages_read_plainly(age_s: float, text: str) -> None:
    assert age_text(age_s) == text
