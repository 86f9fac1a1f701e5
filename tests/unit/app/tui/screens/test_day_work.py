"""The day's list on Procedures: one key opens each stage, and work on stored data is done there."""

import asyncio
from pathlib import Path

import pytest

from catseye.app.service.command_process import Done
from catseye.app.tui.dialogs.start_dialog import StartDialog
from catseye.app.tui.screens.procedures import ProceduresScreen
from catseye.app.tui.screens.results import ResultsScreen
from catseye.app.tui.widgets.parameter_form import ParameterForm
from tests.unit.app.tui.screens.surveyed import DATA_WAY, IDENTIFY, chosen, day, lines, procedures, stage
from tests.unit.app.tui.scripted import (
    failed,
    settled,
    shown,
    work_of,
)
from tests.unit.app.tui.scripted_bench import BENCH


@pytest.mark.parametrize("key", ["enter", "n"])
async def test_one_key_does_the_next_work_on_data(key: str) -> None:
    async with day(DATA_WAY) as (app, pilot):
        work = work_of(app)
        assert "error maps from the distances" in await settled(app, pilot)
        work.outcomes["identify"] = Done((), 0, "", "")
        identified = stage("identify", "done", procedure=False, found="maps U ≤ 5.2 mdeg (k = 2)", **IDENTIFY)
        following = [*DATA_WAY[:4], identified, stage("reflector-search", "next")]
        work.outcomes["procedures"] = Done((), 0, lines(following), "")
        await pilot.press(key)
        text = await settled(app, pilot)
        assert work.done[-2] == ("identify", "00beef", "-o", "result-00beef.json")
        assert "maps U ≤ 5.2 mdeg" in text
        assert "→ reflector-search" in text
        assert "result-00beef.json" in text


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
async def test_the_next_stage_is_seen_however_long_the_day(size: tuple[int, int]) -> None:
    done = [
        stage(f"stage-{n}", "done", procedure=False, found="maps U ≤ 5.9 mdeg (k = 2)") for n in range(14)
    ]
    async with day([*done, stage("dossier", "next", procedure=False)], size) as (app, pilot):
        assert "→ dossier" in await settled(app, pilot)
        await pilot.press("home")
        assert "✓ stage-0" in await settled(app, pilot)


async def test_the_last_stage_is_seen_once_the_day_is_done() -> None:
    dossier = stage("dossier", "done", procedure=False, words=["dossier"], files=["dossier.html"])
    done = [*(stage(f"stage-{n}", "done", procedure=False, found="+0.08 mrad") for n in range(14)), dossier]
    async with day(done) as (app, pilot):
        assert "✓ dossier" in await settled(app, pilot)


async def test_the_next_stage_stays_in_sight_where_lines_get_fewer() -> None:
    stages = [*(stage(f"stage-{n}", "done") for n in range(30)), stage("dossier", "next", procedure=False)]
    async with day(stages) as (app, pilot):
        assert "→ dossier" in await settled(app, pilot)
        # What works says so in a line of its own, below the list.
        await pilot.resize_terminal(120, 32)
        assert "→ dossier" in await settled(app, pilot)


async def test_a_failed_work_says_why_and_stays_next() -> None:
    async with day(DATA_WAY) as (app, pilot):
        work_of(app).outcomes["identify"] = failed(1, "the distances do not determine L2")
        await pilot.press("enter")
        assert "the distances do not determine L2" in await settled(app, pilot)
        await pilot.press("escape")
        assert "→ identify" in await settled(app, pilot)


async def test_a_bench_that_comes_back_is_looked_at_again() -> None:
    async with procedures(size=(120, 40)) as (app, pilot, link):
        robot = {**BENCH["devices"][0], "link": "lost", "error": "no answer for 3 s"}
        link.publish("bench", **{**BENCH, "devices": [robot, *BENCH["devices"][1:]]})
        await settled(app, pilot)
        lost = {**stage("open-loop", "next"), "lost": "bench restarted since"}
        work_of(app).outcomes["procedures"] = Done((), 0, lines([lost]), "")
        link.publish("bench", **BENCH)
        text = await settled(app, pilot)
        assert "→ open-loop" in text
        assert "bench restarted since" in text


async def test_enter_on_a_procedure_shows_what_would_begin() -> None:
    async with day([stage("reflector-search", "next"), stage("open-loop", "later")]) as (app, pilot):
        assert chosen(app) == "reflector-search"
        await pilot.press("down")
        await settled(app, pilot)
        assert chosen(app) == "open-loop"
        await pilot.press("up", "enter")
        text = await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)
        assert "reflector-search on cell lab-1" in text
        # Enter again lets nothing move.
        await pilot.press("enter")
        await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)
        assert not any(words[0] == "run" for words in work_of(app).done)


@pytest.mark.parametrize("key", ["enter", "n"])
async def test_no_stage_opens_while_the_cell_is_looked_at(key: str) -> None:
    async with day([stage("reflector-search", "next"), stage("open-loop", "later")]) as (app, pilot):
        # A run has ended: what was next may be done.
        known = work_of(app).held["procedures"] = asyncio.Event()
        await pilot.press("ctrl+u", key)
        assert "wait a moment" in await shown(app, pilot)
        assert not isinstance(app.screen, StartDialog)
        known.set()
        await settled(app, pilot)
        await pilot.press(key)
        await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)


async def test_a_stage_opens_before_its_fields_are_there() -> None:
    async with day([stage("reflector-search", "next"), stage("open-loop", "later")]) as (app, pilot):
        screen = app.screen
        assert isinstance(screen, ProceduresScreen)
        # On a busy computer the fields of another procedure take a while: the key comes before them.
        screen.show_procedure("open-loop")
        assert screen.query_one(ParameterForm).is_filling
        screen.action_start()
        assert "open-loop on cell lab-1" in await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)


async def test_work_asks_for_the_file_that_only_a_person_knows(tmp_path: Path) -> None:
    asked = {
        "words": ["compensate", "map.json", "--path", "{path}", "-o", "compensated.csv"],
        "asks": [{"name": "path", "what": "path to compensate", "hint": "CSV or TOML"}],
    }
    path = tmp_path / "path.csv"
    path.write_text("x_mm,y_mm\n", encoding="utf-8")
    async with day([stage("compensate", "next", procedure=False, **asked)]) as (app, pilot):
        work = work_of(app)
        work.outcomes["compensate"] = Done((), 0, "", "")
        await pilot.press("enter", *"none.csv", "enter")
        assert "there is no file none.csv" in await settled(app, pilot)
        await pilot.press(*["backspace"] * 8, *str(path), "enter")
        await settled(app, pilot)
        assert ("compensate", "map.json", "--path", str(path), "-o", "compensated.csv") in work.done


async def test_no_key_starts_a_procedure_from_work_on_data() -> None:
    async with day(DATA_WAY) as (app, pilot):
        await pilot.press("ctrl+s", "ctrl+r", "w")
        assert "this step moves nothing" in await settled(app, pilot)
        assert not isinstance(app.screen, StartDialog)
        assert not any(words[0] == "run" for words in work_of(app).done)


async def test_enter_on_a_finished_result_shows_the_file_it_has() -> None:
    identified = stage("identify", "done", procedure=False, files=["/bench/map.json"], **IDENTIFY)
    async with day([identified]) as (app, pilot):
        await pilot.press("enter")
        text = await settled(app, pilot)
        assert isinstance(app.screen, ResultsScreen)
        assert "/bench/map.json is not among the results here" in text


async def test_work_done_again_overwrites_nothing(tmp_path: Path) -> None:
    path, written = tmp_path / "path.csv", tmp_path / "compensated.csv"
    for file in (path, written):
        file.write_text("", encoding="utf-8")
    asked = {
        "words": ["compensate", "map.json", "--path", "{path}", "-o", str(written)],
        "asks": [{"name": "path", "what": "path", "hint": "CSV or TOML"}],
        "files": [str(written)],
    }
    async with day([stage("compensate", "done", procedure=False, **asked)]) as (app, pilot):
        work_of(app).outcomes["compensate"] = Done((), 0, "", "")
        await pilot.press("enter", *str(path), "enter")
        await settled(app, pilot)
        again = str(tmp_path / "compensated-2.csv")
        assert ("compensate", "map.json", "--path", str(path), "-o", again) in work_of(app).done


@pytest.mark.parametrize(
    ("state", "said"), [("later", "it waits for a complete run"), ("left out", "this cell cannot make")]
)
async def test_work_with_nothing_to_work_on_says_so(state: str, said: str) -> None:
    facts = {"words": ["identify", "RUN", "-o", "result-RUN.json"]}
    why = "it takes a run of open-loop, which this cell cannot make"
    waiting = {**stage("identify", state, procedure=False, **facts), "text": why}
    async with day([waiting]) as (app, pilot):
        await pilot.press("enter")
        assert said in await settled(app, pilot)
        assert not any(words[0] == "identify" for words in work_of(app).done)


async def test_back_from_work_on_data_shows_no_other_procedure() -> None:
    async with day(DATA_WAY) as (app, pilot):
        await pilot.press("v", "escape")
        assert "error maps from the distances" in await settled(app, pilot)
