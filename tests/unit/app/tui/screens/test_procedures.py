"""The screen of procedures: list, needs, parameters, rehearsal and start, by every key."""

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from textual.widgets import ContentSwitcher, Input, OptionList, Select

from catseye.app.protocol.commands import CommandEvent, CommandProgress
from catseye.app.protocol.rehearsal import Rehearsal
from catseye.app.protocol.requests import Start
from catseye.app.service.command_process import Done
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.start_dialog import StartDialog
from catseye.app.tui.rehearsing import Verdict
from catseye.app.tui.screens.procedures import ProceduresScreen
from catseye.app.tui.screens.run import RunScreen
from catseye.app.tui.start_text import start_rows
from catseye.app.tui.widgets.parameter_form import ParameterForm
from catseye.app.tui.widgets.procedure_list import ProcedureList
from tests.unit.app.tui.screens.surveyed import (
    LISTED,
    SIZES,
    WAY,
    app_of,
    chosen,
    lines,
    procedures,
)
from tests.unit.app.tui.scripted import (
    ScriptedLink,
    ScriptedWork,
    changed_screen,
    failed,
    make_app,
    settled,
    shown,
    work_of,
)
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import REHEARSAL, RUN


@pytest.mark.parametrize("size", SIZES)
async def test_needs_last_run_and_next_step(size: tuple[int, int]) -> None:
    async with procedures(size=size) as (app, pilot, link):
        link.publish("bench", **BENCH)
        text = await settled(app, pilot)
        assert chosen(app) == "open-loop"
        assert "2 h ago" in text
        assert not changed_screen(f"procedures-{size[0]}x{size[1]}", text)
        words = (
            "procedures",
            "--cell",
            "/bench/cell.toml",
            "--runs",
            "/bench/catseye-runs",
            "--offline",
            "--json",
        )
        assert sorted(work_of(app).done) == [words, ("procedures", "--json")]


@pytest.mark.parametrize("size", SIZES)
async def test_a_rehearsal_with_totals_warnings_and_questions(size: tuple[int, int]) -> None:
    async with procedures(size=size) as (app, pilot, _link):
        await settled(app, pilot)
        await pilot.press("ctrl+r")
        text = await settled(app, pilot)
        assert "8 steps, 16 moves, 8 distances" in text
        assert not changed_screen(f"procedures-rehearsal-{size[0]}x{size[1]}", text)
        words = ("run", "open-loop", "--cell", "/bench/cell.toml", "--runs", "/bench/catseye-runs")
        assert work_of(app).done[-1] == (*words, "--search", "auto", "--dry-run", "--json")
        await pilot.press("v")
        text = await shown(app, pilot)
        assert "Parameters" in text
        assert ("What it does" in text) == (size[1] > 32)
        if size[1] <= 32:
            await pilot.press("v")
            text = await shown(app, pilot)
            assert "What it does" in text
            assert not changed_screen("procedures-explained-80x24", text)
        await pilot.press("v")
        assert "Rehearsal" in await shown(app, pilot)


async def test_other_sizes_show_the_same() -> None:
    app = app_of(ScriptedLink())
    async with app.run_test(size=(40, 12)) as pilot:
        await settled(app, pilot)
        for size in ((60, 20), (200, 60), (40, 12), (100, 30)):
            await pilot.resize_terminal(*size)
            for key, shown_part, rehearsal in (("ctrl+r", "Rehearsal", True), ("v", "Parameters", False)):
                await pilot.press(key)
                text = await settled(app, pilot)
                assert max(map(len, text.splitlines())) <= size[0]
                assert chosen(app) == "open-loop"
                assert (app.screen.query_one(ContentSwitcher).current == "rehearsal") == rehearsal
                assert shown_part in text or size[1] < 20, (size, key)


async def test_the_list_is_filtered_and_sorted_by_keys() -> None:
    async with procedures() as (app, pilot, _link):
        await settled(app, pilot)
        listed = app.screen.query_one(ProcedureList)
        all_names = listed.names
        await pilot.press("slash", *"search")
        assert "/ search▏" in await settled(app, pilot)
        assert listed.names == ["reflector-search"]
        assert app.screen.query_one("#needs").border_title == "Reflector search"
        await pilot.press("escape")
        await settled(app, pilot)
        assert listed.names == all_names
        await pilot.press("s")
        assert "Procedures ▲" in await settled(app, pilot)
        assert listed.names == sorted(all_names)
        await pilot.press("s")
        await settled(app, pilot)
        assert listed.names == all_names


async def test_the_next_step_ends_a_filter_that_hides_it() -> None:
    async with procedures() as (app, pilot, _link):
        await settled(app, pilot)
        await pilot.press("slash", *"search", "enter", "n", "escape")
        await settled(app, pilot)
        assert chosen(app) == "open-loop"
        assert "open-loop" in app.screen.query_one(ProcedureList).names


async def test_a_long_list_uses_the_height_of_the_screen() -> None:
    async with procedures(size=(200, 60)) as (app, pilot, _link):
        await settled(app, pilot)
        listed = app.screen.query_one("#list", OptionList)
        listed.add_options([f"further-{number}" for number in range(20 - listed.option_count)])
        for size, least in (((200, 60), 20), ((80, 24), 5)):
            await pilot.resize_terminal(*size)
            await settled(app, pilot)
            assert listed.size.height >= least
            # Nothing of it, such as the chosen line, lies under the edge of its panel.
            assert app.screen.query_one("#list-panel").content_region.contains_region(listed.region)


async def test_a_fault_is_shown_beside_its_field_and_nothing_begins() -> None:
    async with procedures(notifications=True) as (app, pilot, link):
        await settled(app, pilot)
        await pilot.press("enter")
        focused = app.focused
        assert isinstance(focused, Input)
        # The end of a run has everything looked at again, but leaves the field that somebody types in.
        looked_at = len(work_of(app).done)
        link.publish("run-started", procedure="warmup", title="Warm-up", run=RUN)
        link.publish("run-ended", status="complete", exit_code=0, text="", path="", drives_on=False, run=RUN)
        await settled(app, pilot)
        assert [words[0] for words in work_of(app).done[looked_at:]] == ["procedures"]
        assert app.focused is focused
        await pilot.press("tab", "tab", "tab", "9", "9")
        text = await settled(app, pilot)
        assert "✗ 0 … 20" in text
        assert "returns to an early pose for each reflector" in text
        await pilot.press("ctrl+s")
        assert "Returns (closures): a whole number," in await settled(app, pilot)
        assert not isinstance(app.screen, StartDialog)
        await pilot.press("backspace")
        assert "✗ 0 … 20" not in await settled(app, pilot)


async def test_what_was_typed_is_remembered_and_passed_on() -> None:
    async with procedures(size=(120, 40)) as (app, pilot, _link):
        await settled(app, pilot)
        await pilot.press("enter", *"P1,P2", "tab")
        app.screen.query_one(ParameterForm).query(Select).first().value = "false"
        await settled(app, pilot)
        await pilot.press("escape", "tab", "up")
        await settled(app, pilot)
        assert chosen(app) == "beam-to-j4"
        await pilot.press("down")
        text = await settled(app, pilot)
        assert "P1,P2" in text
        await pilot.press("ctrl+r")
        await settled(app, pilot)
        words = work_of(app).done[-1]
        assert [words[n + 1] for n, word in enumerate(words) if word == "--param"] == [
            'reflectors=["P1", "P2"]',
            "subdivide=false",
        ]


async def test_f8_begins_and_enter_does_not() -> None:
    async with procedures() as (app, pilot, link):
        link.publish("bench", **BENCH)
        await settled(app, pilot)
        await pilot.press("ctrl+s", "escape")
        await settled(app, pilot)
        assert not isinstance(app.screen, StartDialog)
        assert link.asked == []
        await pilot.press("ctrl+s")
        text = await settled(app, pilot)
        assert not changed_screen("procedures-start-80x24", text)
        await pilot.press("enter", "space", "y")
        await settled(app, pilot)
        assert link.asked == []
        await pilot.press("f8")
        await settled(app, pilot)
        assert link.ops == ["control", "start"]
        assert link.asked[1] == Start(procedure="open-loop", cell="/bench/cell.toml", params=[])
        assert isinstance(app.screen, RunScreen)


async def test_real_hardware_is_armed_by_the_name_of_the_cell() -> None:
    async with procedures() as (app, pilot, link):
        link.publish("bench", **{**BENCH, "simulated": False})
        await settled(app, pilot)
        assert not [row for row in app.screen.query_one(ParameterForm).rows if row.parameter == "speed"]
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        assert isinstance(app.focused, Input)
        await pilot.press("f8")
        assert "type lab-1 to arm them" in await settled(app, pilot)
        await pilot.press(*"lab-2", "f8")
        await settled(app, pilot)
        assert link.asked == []
        await pilot.press("f12")
        assert link.ops == ["stop"]
        await pilot.press("backspace", "1", "f8")
        await settled(app, pilot)
        (start,) = link.asked_for(Start)
        assert (start.arm, start.speed) == ("lab-1", 1.0)


async def test_the_start_dialog_shows_the_matching_rehearsal() -> None:
    async with procedures(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **BENCH)
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        text = await settled(app, pilot)
        assert "rehearsed  ! no" in text
        assert "override   10 %, at most 20 %" in text
        await pilot.press("escape", "ctrl+r")
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        text = await settled(app, pilot)
        # Where the arm goes first, and not where the first step ends.
        assert "target     J1 -150.00°, J2 0.00°, J3 50.0 mm, J4 30.00°" in text
        assert "distance   J1 by 170.00°, J2 by 60.00°, J4 by 177.37°" in text
        assert "about 5 s, 8 steps, 8 points" in text
        # What was rehearsed before a run is marked after it.
        await pilot.press("escape")
        link.publish("run-started", procedure="reflector-search", title="Search", run=RUN)
        link.publish("run-ended", status="complete", exit_code=0, text="", path="", drives_on=False, run=RUN)
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        assert "STALE, runs or cell may have changed since" in await settled(app, pilot)


async def test_a_start_that_moves_nothing_says_so() -> None:
    rehearsal = Rehearsal.model_validate_json(REHEARSAL.out)
    still = [step.model_copy(update={"moves": 0, "first": None}) for step in rehearsal.steps]
    verdict = Verdict("found", rehearsal.model_copy(update={"steps": tuple(still)}))
    async with procedures(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **BENCH)
        await settled(app, pilot)
        rows = start_rows(link.engine, verdict, link.now_s)
    assert rows[0] == "target     none: the arm stands still; its drives go on"
    assert not any(row.startswith("speed") for row in rows)


async def test_a_refused_start_shows_its_remedy_and_is_not_pending() -> None:
    link = ScriptedLink()
    link.refusals["start"] = "the engine is aborted: clear it first"
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await settled(app, pilot)
        screen = app.screen
        assert isinstance(screen, ProceduresScreen)
        # Keys can come faster than fields: these are still those of the procedure before.
        screen._choose("beam-to-j4")  # noqa: SLF001  # what the list announces, without a turn of the loop between
        screen.action_start()
        assert len(app.screen_stack) == 1
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)
        await pilot.press("f8")
        text = await settled(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "→ clear it first" in text
        await pilot.press("escape")
        text = await settled(app, pilot)
        assert "planned" not in text
        assert "wait" not in text


async def test_lost_devices_refused_plans_and_missing_cells_are_shown() -> None:
    async with procedures(size=(120, 40), notifications=True) as (app, pilot, link):
        named = {command.title for command in app.get_system_commands(app.screen)}
        assert {"Rehearse the procedure", "Start the procedure", "Open the next step"} <= named
        robot = {**BENCH["devices"][0], "link": "lost", "error": "no answer for 3 s"}
        link.publish("bench", **{**BENCH, "devices": [robot, *BENCH["devices"][1:]]})
        assert "✗ devices: robot: no answer for 3 s" in await settled(app, pilot)
        await pilot.press("up")
        assert chosen(app) == "beam-to-j4"
        await pilot.press("n")
        assert "20261121T080000Z_open-loop_00beef" in await settled(app, pilot)
        assert isinstance(app.screen, StartDialog)
        await pilot.press("escape")
        await settled(app, pilot)
        assert chosen(app) == "open-loop"
        work_of(app).outcomes["run"] = failed(2, "P2 is too near: move it away")
        await pilot.press("ctrl+r")
        assert "✗ P2 is too near: move it away" in await settled(app, pilot)
        work_of(app).outcomes["procedures"] = failed(2, "cell.toml: there is no such file")
        await pilot.press("ctrl+u")
        await settled(app, pilot)
        link.publish("bench", **BENCH)
        assert "there is no such file" in await settled(app, pilot)
        await pilot.press("ctrl+s")
        assert "the cell has not been read yet" in await settled(app, pilot)
        assert not isinstance(app.screen, StartDialog)


async def test_a_cell_file_with_a_fault_is_shown() -> None:
    app = make_app(ScriptedLink(), "procedures")
    work_of(app).outcomes["procedures"] = failed(2, "cell.toml, line 3: unknown key")
    async with app.run_test(size=(80, 24)) as pilot:
        assert "✗ cell.toml, line 3: unknown key" in await settled(app, pilot)
        await pilot.press("ctrl+r", "ctrl+s")
        await settled(app, pilot)
        assert not isinstance(app.screen, StartDialog)


class SlowWork(ScriptedWork):
    """A rehearsal that never comes to its end by itself."""

    def __init__(self, output: str) -> None:
        super().__init__()
        self.outcomes["procedures"] = Done((), 0, output, "")
        self.cancelled = False

    async def do(self, *arguments: str | Path, heard: Callable[[CommandEvent], None] | None = None) -> Done:
        if arguments[0] != "run":
            return await super().do(*arguments, heard=heard)
        try:
            await asyncio.Event().wait()
        except asyncio.CancelledError:
            self.cancelled = True
            raise
        raise AssertionError


class SlowSurvey(ScriptedWork):
    """What the cell is ready for is known when a test says so."""

    def __init__(self) -> None:
        super().__init__()
        self.known = asyncio.Event()

    async def do(self, *arguments: str | Path, heard: Callable[[CommandEvent], None] | None = None) -> Done:
        if "--cell" not in arguments:
            listed = "\n".join(json.dumps({**each, "needs": [], "last": None}) for each in LISTED)
            return Done((), 0, listed, "")
        if heard is not None:
            said = "7 of 18 plans tried, open-loop next"
            heard(CommandProgress(title="procedures", share=0.4, elapsed_s=2.0, left_s=None, text=said))
        await self.known.wait()
        return Done((), 0, lines(WAY), "")


async def test_procedures_are_listed_before_their_plans_are_known() -> None:
    app = make_app(ScriptedLink(), "procedures")
    work = SlowSurvey()
    app.session.work = work
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        await pilot.pause()
        text = await shown(app, pilot)
        assert "· open-loop" in text
        assert "reading cell and runs" in text
        assert "7 of 18 plans" in text
        await pilot.press("ctrl+s")
        assert "wait a moment" in await shown(app, pilot)
        assert not isinstance(app.screen, StartDialog)
        work.known.set()
        text = await settled(app, pilot)
        assert chosen(app) == "open-loop"
        assert "2 h ago" in text


async def test_a_choice_made_while_plans_are_unknown_stays() -> None:
    app = make_app(ScriptedLink(), "procedures")
    work = SlowSurvey()
    app.session.work = work
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause()
        await pilot.press("tab", "down", "down")
        assert chosen(app) == "reflector-search"
        work.known.set()
        assert "P2 is too near" in await settled(app, pilot)
        assert chosen(app) == "reflector-search"


async def test_a_rehearsal_is_ended_by_escape() -> None:
    app = make_app(ScriptedLink(), "procedures")
    work = SlowWork(lines(WAY))
    app.session.work = work
    async with app.run_test(size=(80, 24)) as pilot:
        await settled(app, pilot)
        await pilot.press("ctrl+r")
        assert "Esc ends it" in await shown(app, pilot)
        await pilot.press("escape")
        text = await settled(app, pilot)
        assert work.cancelled
        assert "ended before it was complete" in text


async def test_typed_parameters_are_not_kept_for_another_cell() -> None:
    async with procedures() as (app, pilot, _link):
        await settled(app, pilot)
        row = next(row for row in app.screen.query_one(ParameterForm).rows if row.parameter == "search")
        row.query_one(Input).value = "20261121T080000Z_reflector-search_c0ffee"
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        assert "c0ffee" in await settled(app, pilot)
        await pilot.press("escape")
        app.session.cell = Path("/bench/other.toml")
        await settled(app, pilot)
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        text = await settled(app, pilot)
        assert "aim: auto" in text
        assert "other.toml" in text


async def test_arrows_faster_than_forms_end_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    cancelled: list[str] = []
    mounted = ParameterForm.mount_all

    async def slow(form: ParameterForm, *widgets: Any, **named: Any) -> None:
        try:
            await asyncio.sleep(0)
            await mounted(form, *widgets, **named)
        except asyncio.CancelledError:
            cancelled.append(form.procedure)
            raise

    monkeypatch.setattr(ParameterForm, "mount_all", slow)
    async with procedures() as (app, pilot, _link):
        await settled(app, pilot)
        options = app.screen.query_one("#list", OptionList)
        for _ in range(7):
            options.action_cursor_up()
            await asyncio.sleep(0)
        await settled(app, pilot)
        assert cancelled == []
        assert app.screen.query_one(ParameterForm).procedure == chosen(app) == "beam-to-j4"
