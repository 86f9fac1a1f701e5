"""The next sensible step follows what is stored of a cell, and nothing else."""

import json
import os
import sqlite3
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from catseye.app.cell.templates import RESOLUTION
from catseye.app.cli.init import init
from catseye.app.cli.procedures import procedures as list_procedures
from catseye.app.protocol.bench import DeviceStatus, LinkState
from catseye.app.results.readiness.after_run import after_run
from catseye.app.results.readiness.bench_seen import BenchSeen
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.headline import Headline
from catseye.app.results.readiness.need import Need, links_need
from catseye.app.results.readiness.stages import Place, stages_of
from catseye.app.results.stored_results import results_in
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.procedure import Procedure, Stage
from catseye.procedures.kit.records import Json
from tests.unit.app.results.readiness.history import History

START = datetime(2026, 11, 21, 9, 0, tzinfo=UTC)


@pytest.fixture
def history(tmp_path: Path) -> History:
    return History(tmp_path)


async def test_an_optional_stage_is_never_in_the_way(history: History) -> None:
    assert history.stages()["radial-error-motion"].state == "left out"
    assert history.stages()["radial-error-motion"].text.startswith("optional; ")
    assert history.stages()["budget"].state == "left out"
    run = await history.put("radial-error-motion")
    # What is left of the way is not gone on without, and the budget is open.
    assert history.next() == "beam-level"
    assert history.stages()["budget"].state == "later"
    assert history.stages()["budget"].command == (
        f"catseye budget {run.rpartition('_')[2]} --cell {history.cell}"
    )
    await history.put("reflector-search")
    await history.put("open-loop")
    assert history.stages()["budget"].text.startswith("gone on without it")


async def test_a_budget_with_the_run_is_done(history: History) -> None:
    run = await history.put("radial-error-motion")
    history.taken = frozenset({run})
    stage = history.stages()["budget"]
    assert (stage.state, stage.text) == ("done", "in cell.toml")


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
    history.write("map.json", json.dumps(result))
    assert history.next() == "identify conventional"
    # Whatever its name: the file says of which run and model it is.
    history.write("links.json", json.dumps({**result, "model": "conventional"}))
    stages, folder = history.stages(), history.cell.parent
    assert stages["identify"].results == (folder / "map.json",)
    assert (stages["identify conventional"].files, stages["identify conventional"].results) == (
        (folder / "links.json",),
        (),
    )
    assert history.next() == "validation-path"
    open_loop = measured.rpartition("_")[2]
    driven = (await history.put("validation-path")).rpartition("_")[2]
    assert history.next() == "validate"
    assert history.stages()["validate"].words == (
        *("validate", str(history.cell.parent / "map.json"), "--measured", driven),
        *("-o", f"validation-{driven}.html"),
    )
    for file, following in (
        (f"validation-{driven}.html", "compensate"),
        (f"compensated-{open_loop}.csv", "report"),
    ):
        history.write(file)
        assert history.next() == following
    assert history.stages()["compensate"].asks[0].name == "path"
    history.write(f"arm-{open_loop}.html")
    assert {stage.state for stage in history.stages().values() if stage.name == "report"} == {"done"}
    assert history.next() == "dossier"
    assert history.stages()["dossier"].words == ("dossier", str(history.cell), "-o", "dossier-cell.html")


async def test_a_dossier_holds_until_something_is_newer(history: History) -> None:
    measured = ""
    for name in ("reflector-search", "open-loop"):
        measured = await history.put(name)
    result = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": [measured]}}
    history.write("map.json", json.dumps(result))
    history.write("dossier-cell.html")
    assert history.stages()["dossier"].state == "done"
    history.write(f"arm-{measured[-6:]}.html")
    assert history.stages()["dossier"].state != "done"
    history.write("dossier-cell.html")
    assert history.stages()["dossier"].state == "done"
    driven = await history.put("validation-path")
    history.written_s += 1.0
    os.utime(history.root / driven / "run.sqlite", (history.written_s, history.written_s))
    assert history.stages()["dossier"].state != "done"


async def test_each_stage_names_its_runs_and_files(history: History) -> None:
    for name in ("reflector-search", "open-loop"):
        measured = await history.put(name)
    result = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": [measured]}}
    history.write("map.json", json.dumps(result))
    driven = await history.put("validation-path")
    history.write(f"validation-{driven[-6:]}.html")
    stages, folder = history.stages(), history.cell.parent
    assert (stages["open-loop"].runs, stages["open-loop"].files) == ((measured,), ())
    assert (stages["identify"].runs, stages["identify"].files) == ((measured,), (folder / "map.json",))
    assert stages["validate"].runs == (driven,)
    assert stages["validate"].files == (folder / f"validation-{driven[-6:]}.html",)
    assert (stages["beam-level"].runs, stages["compensate"].files) == ((), ())


async def test_a_page_older_than_the_result_is_not_done(history: History) -> None:
    for name in ("reflector-search", "open-loop", "validation-path"):
        run = await history.put(name)
    history.write(f"validation-{run[-6:]}.html")
    measured = history.survey().runs.last_complete("open-loop")
    assert measured is not None
    result = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": [measured.name]}}
    history.write("map.json", json.dumps(result))
    assert history.stages()["validate"].state != "done"


@pytest.mark.parametrize(("passed", "state"), [(True, "done"), (False, "failed")])
async def test_a_validation_is_done_only_if_its_test_passed(
    history: History, state: str, *, passed: bool
) -> None:
    for name in ("reflector-search", "open-loop", "validation-path"):
        run = await history.put(name)
    measured = history.survey().runs.last_complete("open-loop")
    assert measured is not None
    result = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": [measured.name]}}
    history.write("map.json", json.dumps(result))
    history.write("links.json", json.dumps({**result, "model": "conventional"}))
    page = f"validation-{run[-6:]}.html"
    history.write(page)
    stages = history.stages(headlines={page: Headline("92 µm → 10.9 µm", holds=passed)})
    stage = stages["validate"]
    assert (stage.state, stage.found) == (state, "92 µm → 10.9 µm")
    assert stage.files == (history.cell.parent / page,)
    # Validating once more gives the same figure: the day goes on.
    assert stages["compensate"].state == "next"


async def test_a_run_that_missed_its_tolerance_is_next_again(history: History) -> None:
    run = await history.put("beam-level")
    headlines = {run: Headline("+0.40 of ±0.2 mrad", holds=False)}
    stage = history.stages(headlines=headlines)["beam-level"]
    assert (stage.state, stage.found) == ("next", "not reached: +0.40 of ±0.2 mrad")
    headlines = {run: Headline("+0.08 of ±0.2 mrad")}
    stage = history.stages(headlines=headlines)["beam-level"]
    assert (stage.state, stage.found) == ("done", "+0.08 of ±0.2 mrad")


async def test_going_on_beyond_a_missed_tolerance_leaves_it_out(history: History) -> None:
    run = await history.put("beam-level")
    await history.put("beam-to-j4")
    stage = history.stages(headlines={run: Headline("+0.40 of ±0.2 mrad", holds=False)})["beam-level"]
    assert (stage.state, stage.found) == ("left out", "not reached: +0.40 of ±0.2 mrad")


async def test_levelling_again_makes_alignment_next_and_keeps_the_search(history: History) -> None:
    for name in ("beam-level", "beam-to-j4", "reflector-search", "beam-level"):
        await history.put(name)
    assert history.next() == "beam-to-j4"
    assert history.stages()["reflector-search"].state == "done"


async def test_nothing_holds_on_a_bench_that_was_restarted(history: History) -> None:
    for name in ("beam-level", "beam-to-j4", "reflector-search", "warmup"):
        await history.put(name, started="first")
    assert history.stages(present=BenchSeen("first"))["open-loop"].state == "next"
    stages = history.stages(present=BenchSeen("second"))
    assert [stages[name].state for name in ("beam-level", "reflector-search")] == ["next", "later"]
    for name in ("beam-level", "beam-to-j4", "reflector-search", "warmup"):
        assert stages[name].lost == "bench restarted since"
        assert not stages[name].runs
    assert "bench restarted since" in stages["beam-level"].text
    # A run on the restarted bench tells it, too, while no bench answers.
    await history.put("beam-level", started="second")
    stages = history.stages()
    assert [stages[name].state for name in ("beam-level", "beam-to-j4")] == ["done", "next"]
    assert stages["beam-level"].lost == ""


async def test_what_was_begun_before_a_restart_does_not_go_on(history: History) -> None:
    for name, status in (("reflector-search", "complete"), ("open-loop", "stopped")):
        await history.put(name, status, started="first")
    stage = history.stages(present=BenchSeen("second"))["open-loop"]
    assert stage.words[:2] == ("run", "open-loop")


async def test_a_skipped_stage_is_not_next(history: History) -> None:
    await history.put("reflector-search")
    assert history.next() == "warmup"
    stages = history.stages()
    assert stages["beam-level"].state == stages["beam-to-j4"].state == "left out"


async def test_a_warm_arm_cools_down(history: History) -> None:
    for name in ("beam-level", "beam-to-j4", "reflector-search", "warmup"):
        await history.put(name)
    assert history.next() == "open-loop"
    assert history.next(later_s=4 * 3600.0) == "warmup"


async def test_a_measurement_covers_the_warm_up_before_it(history: History) -> None:
    for name in ("reflector-search", "warmup", "open-loop"):
        await history.put(name)
    assert history.stages(later_s=5 * 3600.0)["warmup"].state == "done"


async def test_a_warm_up_that_was_never_made_is_left_out(history: History) -> None:
    for name in ("reflector-search", "open-loop"):
        await history.put(name)
    assert history.stages()["warmup"].state == "left out"


async def test_moving_the_beam_invalidates_the_search(history: History) -> None:
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


async def test_an_analysis_without_possible_runs_is_left_out(history: History) -> None:
    text = history.cell.read_text()
    history.cell.write_text(text.replace("link1_mm = 325.0", "").replace("link2_mm = 225.0", ""))
    survey = history.survey()
    assert {stage.state for stage in survey.stages} == {"left out"}
    (identify,) = [stage for stage in survey.stages if stage.name == "identify"]
    assert "takes a run of open-loop" in identify.text
    assert survey.next is None


async def test_last_runs_and_needs_are_listed(history: History, capsys: pytest.CaptureFixture[str]) -> None:
    run = await history.put("open-loop", status="stopped")
    list_procedures(cell=history.cell, runs=history.root, as_json=True)
    *procedures, stages = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    (open_loop,) = [each for each in procedures if each["name"] == "open-loop"]
    assert open_loop["last"]["name"] == run
    assert open_loop["last"]["status"] == "stopped"
    assert {need["what"] for need in open_loop["needs"]} >= {"reflectors", "search", "warm arm", "plan"}
    assert stages["cell"] == "lab-1"
    list_procedures(cell=history.cell, runs=history.root, as_json=False)
    out = capsys.readouterr()
    assert ["next", "beam-level"] in [line.split()[:2] for line in out.out.splitlines()]
    assert out.err.startswith("next: catseye run beam-level")


@pytest.mark.parametrize("time_utc", ["2026-11-2", "2026-11-21T09:00:00"])
async def test_a_run_with_a_changed_time_is_passed_over(history: History, time_utc: str) -> None:
    sound = await history.put("warmup")
    changed = await history.put("warmup")
    database = history.root / changed / "run.sqlite"
    database.chmod(0o644)
    with closing(sqlite3.connect(database, isolation_level=None)) as connection:
        connection.execute("DROP TRIGGER events_no_update")
        connection.execute("UPDATE events SET time_utc = ?", (time_utc,))
    found = runs_of_cell(history.root, "lab-1", history.clock.now_utc())
    assert [found.named(name) is not None for name in (sound, changed)] == [True, False]


def robot(link: LinkState, error: str | None = None) -> DeviceStatus:
    endpoint = "tcp://127.0.0.1:10001"
    return DeviceStatus(
        name="robot", endpoint=endpoint, driver="melfa-r3", link=link, identity=None, error=error, age_s=None
    )


def test_lost_devices_are_missing_and_unknown_ones_are_not() -> None:
    assert links_need(None).met == "advised"
    assert links_need([robot("ok")]).met == "met"
    lost = links_need([robot("lost", "no answer: is it on?")])
    assert lost.met == "missing"
    assert lost.text == "robot: no answer: is it on?"
    assert links_need([robot("connecting")]).met == "advised"


@pytest.mark.parametrize("provenance", ["anywhere", ["a run"], {"runs": None}, {"runs": 7}, None])
def test_a_result_file_of_another_shape_names_no_run(tmp_path: Path, provenance: Json) -> None:
    document = {"format": "catseye-result/1", "model": "error-map", "provenance": provenance}
    (tmp_path / "odd.json").write_text(json.dumps(document))
    assert not results_in([tmp_path])


def test_only_error_maps_count_as_results(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{")
    (tmp_path / "b.json").write_text('{"format": "catseye-result/1", "model": "conventional"}')
    assert results_in([tmp_path, tmp_path / "none"]) == {}


def test_the_newest_result_of_a_run_counts(history: History) -> None:
    result = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": ["a run"]}}
    for name in ("b.json", "c.json", "a.json", "b.json"):
        history.write(name, json.dumps(result))
    assert results_in([history.cell.parent]) == {"a run": history.cell.parent / "b.json"}


class Measures(Procedure):
    """Stands on one way."""

    name, title, params_type, stage = "measures", "", BaseModel, Stage(10, "one", "first way")

    def plan(self, bench: Any, params: Any) -> None:
        """Plan nothing."""

    async def run(self, ctx: Context, plan: Any) -> None:
        """Do nothing."""


class Steps(Measures):
    """Stands on another way."""

    name, stage = "steps", Stage(20, "two", "second way")


LACKING = [Need("cell file", "missing", "add it to the cell file")]


@pytest.mark.parametrize(
    ("needs", "shown"),
    [
        ({"measures": LACKING, "steps": []}, ["steps"]),
        ({"measures": [], "steps": LACKING}, ["measures"]),
        ({"measures": [], "steps": []}, ["measures", "steps"]),
        ({"measures": LACKING, "steps": LACKING}, ["measures", "steps"]),
    ],
)
def test_only_ways_that_the_cell_is_made_for_are_shown(
    history: History, needs: dict[str, list[Need]], shown: list[str]
) -> None:
    runs = runs_of_cell(history.root, "lab-1", START)
    found = stages_of([Measures(), Steps()], runs, needs, {}, {}, Place(history.cell))
    assert [stage.name for stage in found] == shown


async def test_an_arm_with_optics_is_led_to_its_least_steps(history: History, tmp_path: Path) -> None:
    history.cell = tmp_path / "arm.toml"
    init(history.cell, RESOLUTION)
    names = ["resolution", "resolution-iso", "backlash"]
    survey = history.survey()
    assert [stage.name for stage in survey.stages][:3] == names
    assert survey.next is not None
    assert survey.next.name == "resolution"
    run = await history.put("resolution", cell="arm-1")
    result = {"format": "catseye-resolution/1", "provenance": {"runs": [run]}}
    (tmp_path / "result.json").write_text(json.dumps(result))
    (evaluated,) = [stage for stage in history.survey().stages if stage.name == "least steps"]
    assert (evaluated.state, evaluated.text) == ("done", str(tmp_path / "result.json"))


def evaluated_into(folder: Path, *runs: str, changed_s: float) -> Path:
    """Write a result of runs; return its file."""
    path = folder / f"result-{runs[0].rpartition('_')[2]}.json"
    path.write_text(
        json.dumps({"format": "catseye-resolution/1", "provenance": {"runs": list(runs)}}), encoding="utf-8"
    )
    os.utime(path, (changed_s, changed_s))
    return path


@pytest.mark.parametrize("procedure", ["resolution-iso", "backlash", "resolution-cartesian"])
async def test_every_run_of_steps_is_evaluated_next(history: History, tmp_path: Path, procedure: str) -> None:
    first = await history.put("resolution")
    evaluated_into(tmp_path, first, changed_s=1e9)
    second = await history.put(procedure)
    waiting = history.data_stage("least steps")
    assert waiting.state != "done"
    assert waiting.command.startswith(f"catseye resolution {second.rpartition('_')[2]} -o ")
    both = evaluated_into(tmp_path, second, changed_s=1e9)
    done = history.data_stage("least steps")
    assert (done.state, str(both) in done.text) == ("done", True)
    assert f"result-{first.rpartition('_')[2]}.json" in history.data_stage("report").command
    assert str(both) in history.data_stage("report").command


async def test_a_report_is_done_while_newer_than_the_results(history: History, tmp_path: Path) -> None:
    run = await history.put("resolution")
    evaluated_into(tmp_path, run, changed_s=1e9)
    page = tmp_path / "resolution.html"
    page.write_text("", encoding="utf-8")
    os.utime(page, (1e9 - 1.0, 1e9 - 1.0))
    assert history.data_stage("report").state != "done"
    os.utime(page, (1e9 + 1.0, 1e9 + 1.0))
    report = history.data_stage("report")
    assert (report.state, report.text) == ("done", str(page))


@pytest.mark.parametrize("procedure", ["resolution", "resolution-iso", "backlash", "resolution-cartesian"])
def test_a_run_of_steps_is_advised_to_be_evaluated(tmp_path: Path, procedure: str) -> None:
    run = f"20261121T090000Z_{procedure}_00beef"
    first = after_run(procedure, "complete", run, tmp_path / "runs")[0]
    assert (first.kind, first.command[:2]) == ("analyse", ("resolution", run))
    assert first.writes == tmp_path / "result-00beef.json"


def test_a_calibrated_arm_counts_as_the_result_of_its_run(tmp_path: Path) -> None:
    run = "20261121T080000Z_tracker-calibration_00beef"
    result = {"format": "catseye-serial-arm/1", "provenance": {"runs": [run]}}
    (tmp_path / "arm.json").write_text(json.dumps(result), encoding="utf-8")
    assert results_in([tmp_path]) == {run: tmp_path / "arm.json"}
