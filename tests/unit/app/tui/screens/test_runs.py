"""The screen Runs: what it lists, and every key of it."""

import asyncio
import os
import sqlite3
from collections.abc import AsyncIterator
from contextlib import closing
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.widgets import DataTable, Input, Select

from catseye.app.protocol.commands import CommandProgress
from catseye.app.protocol.requests import Control, Resume
from catseye.app.results.runs.documents import VerificationDocument
from catseye.app.service.command_process import Done
from catseye.app.store.seal import DATABASE
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.dialogs.start_dialog import Permission, StartDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.screens.runs import RunsScreen
from catseye.app.tui.widgets import preview
from catseye.app.tui.widgets.static_text import StaticText
from catseye.app.tui.widgets.task_line import TaskLine
from tests.unit.app.tui.scripted import (
    ScriptedLink,
    ScriptedWork,
    changed_screen,
    failed,
    make_app,
    settled,
    shown,
    started,
    work_of,
)
from tests.unit.app.tui.stored_runs import (
    COMPLETE,
    DAMAGED,
    DIED,
    REAL,
    RUNNING,
    STOPPED,
    make_runs,
)


@pytest.fixture
async def root(tmp_path: Path) -> AsyncIterator[Path]:
    folder = tmp_path / "runs"
    running = await make_runs(folder)
    yield folder
    running.release()


async def settle(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    """Wait for everything that is under way beside the screen, and for what follows from it."""
    await pilot.pause()
    while any(not worker.is_finished for worker in app.workers):
        await app.workers.wait_for_complete()
        await pilot.pause()


def rows(app: CatseyeApp) -> list[list[str]]:
    table = app.screen_stack[0].query_one("#table", DataTable)
    return [[str(cell).strip() for cell in table.get_row(key)] for key in table.rows]


def duration(run: Path) -> timedelta:
    """Return the time from the first event of a run to its last."""
    with closing(sqlite3.connect(run / DATABASE)) as connection:
        times = [datetime.fromisoformat(row[0]) for row in connection.execute("SELECT time_utc FROM events")]
    return max(times) - min(times)


def ids(app: CatseyeApp) -> list[str]:
    return [row[-1] for row in rows(app)]


async def go_to(app: CatseyeApp, pilot: Pilot[Any], name: str) -> None:
    """Put the cursor on a run."""
    await settle(app, pilot)
    table = app.screen.query_one("#table", DataTable)
    table.move_cursor(row=table.get_row_index(name))
    await pilot.pause()


async def test_list_as_it_is_seen(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(app, pilot)
        assert not changed_screen("runs-80x24", await shown(app, pilot))
        screen = app.screen
        assert isinstance(screen, RunsScreen)
        reached = {command.callback.__name__.removeprefix("action_") for command in screen.commands()}
        keys = {binding.action for binding in screen.BINDINGS if not isinstance(binding, tuple)}
        assert keys - {"back"} <= reached
        for size in ((60, 20), (100, 30), (200, 60), (120, 40)):
            await pilot.resize_terminal(*size)
            assert "open-loop" in await shown(app, pilot), size
        assert not changed_screen("runs-120x40", await shown(app, pilot))
        assert ids(app) == ["ffffff", "eeeeee", "dddddd", "cccccc", "bbbbbb", "aaaaaa"]
        table = {row[-1]: row for row in rows(app)}
        assert table["aaaaaa"][1:4] == ["2026-11-19 08:15", "open-loop", "✓ complete"]
        assert table["aaaaaa"][4:6] == [str(duration(root / COMPLETE)), "3"]
        assert [table[name][3] for name in ("bbbbbb", "cccccc", "dddddd", "eeeeee", "ffffff")] == [
            "■ stopped",
            "† died",
            "✗ aborted",
            "! damaged",
            "▶ running",
        ]
        assert [table[name][6] for name in ("aaaaaa", "dddddd", "eeeeee")] == ["SIM", "", "?"]
        assert table["dddddd"][7] == "lab-1"


async def test_words_and_states_filter(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(app, pilot)
        await pilot.press("slash", *"loop stop")
        await settle(app, pilot)
        assert ids(app) == ["bbbbbb"]
        assert "/ loop stop" in await shown(app, pilot)
        await pilot.press("enter", "slash", *(["backspace"] * 9), *"real")
        await settle(app, pilot)
        assert ids(app) == ["dddddd"]
        await pilot.press("escape", "f")
        await settle(app, pilot)
        assert ids(app) == ["aaaaaa"]
        assert "only ✓ complete" in await shown(app, pilot)
        for _ in range(5):
            await pilot.press("f")
        await settle(app, pilot)
        assert ids(app) == ["cccccc"]
        await pilot.press("f", "f")
        await settle(app, pilot)
        assert len(ids(app)) == 6


async def test_only_what_changes_is_changed_and_the_cursor_stays(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    async with app.run_test(size=(80, 24)) as pilot:
        await go_to(app, pilot, DIED)
        assert isinstance(app.screen, RunsScreen)
        (root / COMPLETE).rename(root / "20261121T090000Z_open-loop_999999")
        (root / STOPPED / DATABASE).write_bytes(b"gone")
        app.screen.on_screen_resume()
        await settle(app, pilot)
        assert ids(app) == ["999999", "ffffff", "eeeeee", "dddddd", "cccccc", "bbbbbb"]
        assert rows(app)[-1][3] == "! damaged"
        table = app.screen.query_one("#table", DataTable)
        assert table.coordinate_to_cell_key(table.cursor_coordinate).row_key.value == DIED


async def test_a_thousand_runs(tmp_path: Path, root: Path) -> None:
    many = tmp_path / "many"
    for number in range(1000):
        folder = many / f"2026{number // 200 + 1:02d}01T{number % 24:02d}0000Z_open-loop_{number:06x}"
        folder.mkdir(parents=True)
        os.link(root / COMPLETE / DATABASE, folder / DATABASE)
    app = make_app(ScriptedLink(), "runs", root=many)
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(app, pilot)
        table = app.screen.query_one("#table", DataTable)
        assert table.row_count == 1000
        names = [str(key.value) for key in table.rows]
        assert names == sorted(names, reverse=True)
        await pilot.press("slash", *"0003c")
        await settle(app, pilot)
        assert sorted(ids(app)) == ["00003c", *(f"{number:06x}" for number in range(0x3C0, 0x3D0))]


async def test_timeline(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    work_of(app).outcomes["show"] = Done((), 0, "the whole timeline\nof [a] run\n", "")
    async with app.run_test(size=(80, 24)) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("enter")
        await settle(app, pilot)
        assert work_of(app).done == [("show", STOPPED, "--runs", str(root))]
        text = await shown(app, pilot)
        assert "the whole timeline" in text
        assert "of [a] run" in text
        assert "procedure        state" not in text
        await pilot.press("escape")
        assert "procedure        state" in await shown(app, pilot)
        # Both are seen where there is room.
        await pilot.resize_terminal(120, 40)
        await pilot.press("enter")
        await settle(app, pilot)
        text = await shown(app, pilot)
        assert "the whole timeline" in text
        assert "bbbbbb" in text


CANNOT_GO_ON = ((COMPLETE, "start a new run"), (RUNNING, "a attaches"), (DAMAGED, "k says"))


async def test_a_wide_screen_shows_the_run_under_the_cursor(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preview, "RESTS_S", 1e-3)
    app = make_app(ScriptedLink(), "runs", root=root)
    async with app.run_test(size=(200, 60)) as pilot:
        await go_to(app, pilot, STOPPED)
        await settle(app, pilot)
        await settled(app, pilot)
        told = app.screen.query_one("#preview-text", StaticText).text.plain
        assert "ENDED stopped, exit code 5" in told


async def test_runs_that_cannot_resume_say_why(root: Path) -> None:
    link = ScriptedLink()
    link.refusals["resume"] = "the reflectors were moved: search again and start a new run"
    app = make_app(link, "runs", root=root)
    async with app.run_test(size=(80, 24)) as pilot:
        for name, why in CANNOT_GO_ON:
            await go_to(app, pilot, name)
            await pilot.press("r")
            text = await shown(app, pilot)
            assert isinstance(app.screen, ErrorDialog), name
            assert why in text, name
            assert link.asked == [], name
            await pilot.press("escape")
        await go_to(app, pilot, DIED)
        await pilot.press("r", "f8")
        text = await shown(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "→ search again and start a new run" in text


async def test_resume_is_asked_of_the_engine_after_f8(root: Path) -> None:
    async with started(screen="runs", root=root) as (app, pilot, link):
        # Real hardware is armed by the name of the cell.
        await go_to(app, pilot, REAL)
        await pilot.press("r", "f8")
        await pilot.pause()
        assert link.asked == []
        await pilot.press(*"lab-1", "f8")
        await settle(app, pilot)
        assert link.asked[-1] == Resume(run=REAL, arm="lab-1")
        link.asked.clear()
        link.engine.control = None
        await pilot.press("f7")
        await go_to(app, pilot, STOPPED)
        await pilot.press("r")
        await pilot.pause()
        assert isinstance(app.screen, StartDialog)
        await pilot.press("enter")
        await pilot.pause()
        assert link.asked == []
        await pilot.press("f8")
        await settle(app, pilot)
        assert link.asked == [Control(), Resume(run=STOPPED)]
        assert app.current_mode == "run"


async def test_no_name_is_too_long_for_a_request(root: Path) -> None:
    async with started(screen="runs", root=root) as (app, pilot, link):
        await go_to(app, pilot, REAL)
        await pilot.press("r")
        await pilot.pause()
        assert isinstance(app.screen, StartDialog)
        app.screen.dismiss(Permission("a" * 1001))
        await settle(app, pilot)
        assert f"{REAL} does not go on" in " ".join((await shown(app, pilot)).split())
        assert link.asked == []


async def test_verify(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    outcomes = work_of(app).outcomes
    verified = VerificationDocument(run=STOPPED, sound=True, sealed=True, problems=(), notes=())
    outcomes["verify"] = Done((), 0, verified.model_dump_json(), "")
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("k")
        await settle(app, pilot)
        assert work_of(app).done == [("verify", STOPPED, "--runs", str(root), "--json")]
        assert "numbers agree" in " ".join((await shown(app, pilot)).split())
        # An interrupted command is no error.
        outcomes["verify"] = Done((), 130, "", "interrupted\n")
        await pilot.press("k")
        await settle(app, pilot)
        assert not isinstance(app.screen, ErrorDialog)
        assert "interrupted from outside" in " ".join((await shown(app, pilot)).split())
        outcomes["verify"] = failed(6, f"{STOPPED}: run.sqlite differs from the manifest")
        await pilot.press("k")
        await settle(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "run.sqlite differs from the manifest" in await shown(app, pilot)


async def test_report_says_where_it_is_and_is_opened(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    page = root.parent / "report-bbbbbb.html"
    opened: list[str] = []

    async def open_page(uri: str) -> str:
        opened.append(uri)
        return ""

    monkeypatch.setattr("catseye.app.tui.screens.working.can_open", lambda: True)
    monkeypatch.setattr("catseye.app.tui.screens.working.open_page", open_page)
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("o")
        await settle(app, pilot)
        assert opened == []
        await pilot.press("p")
        await settle(app, pilot)
        assert work_of(app).done == [("report", STOPPED, "--runs", str(root), "-o", str(page))]
        assert "o opens it in the browser" in await shown(app, pilot)
        await pilot.press("o")
        await settle(app, pilot)
        assert opened == [page.as_uri()]
        # Without a display the path is shown.
        monkeypatch.setattr("catseye.app.tui.screens.working.can_open", lambda: False)
        await pilot.press("o")
        assert "there is no display here" in await shown(app, pilot)
        assert opened == [page.as_uri()]


async def test_export_asks_for_a_file_that_is_not_there_yet(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    taken = root.parent / "open-loop-bbbbbb.csv"
    taken.write_text("precious", encoding="utf-8")
    async with app.run_test(size=(120, 40)) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("e")
        await pilot.pause()
        assert isinstance(app.screen, FormDialog)
        file = app.screen.query_one("#file", Input)
        assert file.value == str(root.parent / "open-loop-bbbbbb-2.csv")
        file.value = str(taken)
        await pilot.press("enter")
        assert "open-loop-bbbbbb.csv is there already" in await shown(app, pilot)
        app.screen.query_one("#file", Input).value = str(root.parent / "rows.parquet")
        await pilot.press("enter")
        await settle(app, pilot)
        wanted = ("export", STOPPED, "--runs", str(root), "-o", str(root.parent / "rows.parquet"))
        assert work_of(app).done == [wanted]


async def test_identify_from_marked_runs_and_with_draws(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    result = root.parent / "result-aaaaaa.json"
    async with app.run_test(size=(120, 40)) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("space")
        await settle(app, pilot)
        await pilot.press("space")
        await settle(app, pilot)
        assert [row[-1] for row in rows(app) if row[0]] == ["bbbbbb", "aaaaaa"]
        assert "2 marked" in await shown(app, pilot)
        await pilot.press("i")
        await pilot.pause()
        await pilot.press("ctrl+s")
        await settle(app, pilot)
        expected = ("identify", COMPLETE, STOPPED, "--model", "error-map", "--uncertainty", "jacobian")
        assert work_of(app).done == [(*expected, "--runs", str(root), "-o", str(result))]
        assert not any(row[0] for row in rows(app))
        work_of(app).done.clear()
        await go_to(app, pilot, STOPPED)
        await pilot.press("i")
        await pilot.pause()
        app.screen.query_one("#model", Select).value = "conventional"
        app.screen.query_one("#uncertainty", Select).value = "monte-carlo"
        app.screen.query_one("#draws", Input).value = "many"
        await pilot.press("ctrl+s")
        assert "draws is a whole number" in await shown(app, pilot)
        app.screen.query_one("#draws", Input).value = "4000"
        await pilot.press("ctrl+s")
        await settle(app, pilot)
        words = work_of(app).done[0]
        assert words[:8] == (
            *("identify", STOPPED, "--model", "conventional"),
            *("--uncertainty", "monte-carlo", "--draws", "4000"),
        )


class SlowWork(ScriptedWork):
    """Reports how far it is and goes on until it is cancelled."""

    def __init__(self) -> None:
        super().__init__()
        self.begun = asyncio.Event()
        self.cancelled = False

    async def do(self, *arguments: Any, heard: Any = None) -> Done:
        self.done.append(tuple(str(argument) for argument in arguments))
        draws = "4000 of 10000 draws"
        heard(CommandProgress(title="Monte Carlo", share=0.4, elapsed_s=8.0, left_s=12.0, text=draws))
        self.begun.set()
        try:
            await asyncio.Event().wait()
        except asyncio.CancelledError:
            self.cancelled = True
            raise
        raise AssertionError("it ends by being cancelled only")


async def test_work_shows_its_progress_and_escape_cancels_it(root: Path) -> None:
    link = ScriptedLink()
    app = make_app(link, "runs", root=root)
    app.session.work = work = SlowWork()
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await go_to(app, pilot, STOPPED)
        await pilot.press("k")
        await work.begun.wait()
        link.now_s += 5.0
        app.screen.query_one(TaskLine)._show()  # noqa: SLF001  # what its timer does twice a second
        text = await shown(app, pilot)
        assert "40 %  7 s left  4000 of 10000 draws   Esc cancels" in text
        await pilot.press("p")
        assert len(work.done) == 1
        assert app.session.under_way == ["verify bbbbbb"]
        await pilot.press("escape")
        await settle(app, pilot)
        assert work.cancelled
        assert app.session.under_way == []
        text = await shown(app, pilot)
        assert "verify bbbbbb: cancelled" in text
        assert "Esc cancels" not in text.replace("Esc cancels what is under way", "")


async def test_attach(root: Path) -> None:
    async with started(
        {"run": RUNNING, "procedure": "reflector-search", "title": "", "state": "EXECUTE"}, "runs", root=root
    ) as (app, pilot, _link):
        await go_to(app, pilot, RUNNING)
        await pilot.press("a")
        await pilot.pause()
        assert app.current_mode == "run"


async def test_attach_to_another_engine_shows_the_command(root: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=root)
    async with app.run_test(size=(120, 40)) as pilot:
        await go_to(app, pilot, RUNNING)
        await pilot.press("a")
        text = await shown(app, pilot)
        assert isinstance(app.screen, TextDialog)
        assert f"catseye attach {RUNNING}" in text
        await pilot.press("escape")
        await go_to(app, pilot, STOPPED)
        await pilot.press("a")
        await pilot.pause()
        assert isinstance(app.screen, RunsScreen)


async def test_a_folder_without_runs(tmp_path: Path) -> None:
    app = make_app(ScriptedLink(), "runs", root=tmp_path / "none")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(app, pilot)
        for key in ("enter", "space", "r", "v", "i", "p", "e", "a", "escape"):
            await pilot.press(key)
        await settle(app, pilot)
        assert isinstance(app.screen, RunsScreen)
        assert "no runs in" in await shown(app, pilot)
