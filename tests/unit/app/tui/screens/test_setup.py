"""The screen Set-up: from nothing to a cell file that loads, by keys."""

import json
from pathlib import Path
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.widgets import Input, Select, Static

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cell.templates import SCARA
from catseye.app.cell.wizard.pages import pages_of
from catseye.app.protocol.requests import Watch
from catseye.app.service.command_process import Done
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog
from catseye.app.tui.screens.setup import SetupScreen
from catseye.app.tui.setup.device_test import DeviceTest
from catseye.app.tui.setup.question_row import QuestionRow
from catseye.app.tui.setup.wizard import Wizard
from tests.unit.app.tui.scripted import (
    ScriptedLink,
    changed_screen,
    failed,
    make_app,
    settled,
    shown,
    started,
    work_of,
)

ENDPOINTS = {
    "robot.endpoint": "tcp://192.168.0.20:10001",
    "interferometer.endpoint": "serial:///dev/ttyUSB0?baud=9600",
    "environment.endpoint": "tcp://192.168.0.30:502",
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def first_start() -> tuple[CatseyeApp, ScriptedLink]:
    link = ScriptedLink()
    link.engine.lost("there is no cell file yet: set one up (F10), or try the demo")
    link.cell = None
    app = make_app(link, "setup")
    app.session.cell = None
    return app, link


async def judged(app: CatseyeApp, pilot: Pilot[Any]) -> str:
    await app.screen_stack[0].query_one(Wizard).judge()
    return await shown(app, pilot)


def wizard_of(app: CatseyeApp) -> Wizard:
    return app.screen_stack[0].query_one(Wizard)


async def begin(app: CatseyeApp, pilot: Pilot[Any]) -> Wizard:
    await pilot.press("1")
    await settled(app, pilot)
    return wizard_of(app)


async def to_page(app: CatseyeApp, pilot: Pilot[Any], name: str) -> None:
    wizard = wizard_of(app)
    await wizard.show_page(next(page for page in wizard.draft.pages if page.name == name))
    app.screen.refresh_bindings()
    await pilot.pause()


async def type_answer(app: CatseyeApp, pilot: Pilot[Any], key: str, text: str) -> None:
    row = next(row for row in wizard_of(app).query(QuestionRow) if row.question.key == key)
    field = row.field
    assert isinstance(field, Input)
    field.value = text
    await pilot.pause()


async def answer_all(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    await pilot.press("down", *"lab-7")
    for key, text in ENDPOINTS.items():
        await to_page(app, pilot, key.partition(".")[0])
        await type_answer(app, pilot, key, text)


def give_all(app: CatseyeApp) -> None:
    """Answer without a look at each page, where what comes after the answers is the matter."""
    for key, text in {"name": "lab-7", **ENDPOINTS}.items():
        wizard_of(app).draft.give(key, text)


async def test_start_and_pages_as_they_are_seen() -> None:
    app, _ = first_start()
    async with app.run_test(size=(80, 24)) as pilot:
        assert not changed_screen("setup_start_80x24", await shown(app, pilot))
        await pilot.resize_terminal(120, 40)
        assert not changed_screen("setup_start_120x40", await shown(app, pilot))
        screen = app.screen
        assert isinstance(screen, SetupScreen)
        actions = {binding.action for binding in screen.BINDINGS}  # type: ignore[union-attr]  # all are Binding
        offered = {command.callback.__name__.removeprefix("action_") for command in screen.commands()}
        assert actions == offered
        await begin(app, pilot)
        for size in ((120, 40), (80, 24)):
            await pilot.resize_terminal(*size)
            for page in ("robot", "interferometer", "reflector", "summary"):
                await to_page(app, pilot, page)
                # The cursor blinks by a clock of its own.
                for field in app.screen.query(Input):
                    field.cursor_blink = False
                assert not changed_screen(f"setup_{page}_{size[0]}x{size[1]}", await judged(app, pilot))


async def test_other_sizes() -> None:
    app, _ = first_start()
    async with app.run_test(size=(60, 20)) as pilot:
        await begin(app, pilot)
        sizes = [(60, 20), (100, 30), (200, 60)]
        for page in pages_of(SCARA):
            await to_page(app, pilot, page.name)
            for size in sizes:
                if app.size != size:
                    await pilot.resize_terminal(*size)
                assert page.intro in await shown(app, pilot), (page.name, size)
            sizes.reverse()


async def test_from_nothing_to_a_cell_file(folder: Path) -> None:
    app, link = first_start()
    async with app.run_test(size=(80, 24)) as pilot:
        await begin(app, pilot)
        await answer_all(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        cell = load_cell(folder / "cell.toml").cell
        assert (cell.name, cell.robot.endpoint) == ("lab-7", ENDPOINTS["robot.endpoint"])
        assert "# the program never drives faster" in (folder / "cell.toml").read_text(encoding="utf-8")
        assert work_of(app).done == [("config", "validate", "cell.toml")]
        assert link.cell == app.session.cell == folder / "cell.toml"
        assert not app.screen_stack[0].has_class("wizard")


async def test_a_wrong_answer_is_marked_and_prevents_writing(folder: Path) -> None:
    app, _ = first_start()
    async with app.run_test(size=(80, 24)) as pilot:
        await begin(app, pilot)
        await pilot.press("pagedown", "tab", *"tcp://a:1")
        assert wizard_of(app).draft.answer("robot.endpoint") == "tcp://a:1", "the field had the focus"
        give_all(app)
        await to_page(app, pilot, "robot")
        await type_answer(app, pilot, "robot.link1_mm", "-1")
        assert "✗ Input should be greater than 0, not -1" in await judged(app, pilot)
        await pilot.press("ctrl+s")
        text = await settled(app, pilot)
        assert "Robot: robot.link1_mm" in text
        assert not (folder / "cell.toml").exists()


async def test_drivers_add_questions_and_reflectors_can_be_edited() -> None:
    app, _ = first_start()
    async with app.run_test(size=(120, 40)) as pilot:
        await begin(app, pilot)
        await to_page(app, pilot, "interferometer")
        assert "Profile" in await shown(app, pilot)
        row = next(r for r in wizard_of(app).query(QuestionRow) if r.question.key == "interferometer.driver")
        row.query_one(Select).value = "attocube-ids"
        await settled(app, pilot)
        text = await settled(app, pilot)
        assert "dialect" in text
        assert "Profile" not in text
        await to_page(app, pilot, "reflector")
        await pilot.press("ctrl+g")
        await pilot.pause()
        await pilot.press(*"12", "tab", *"-3")
        await pilot.pause()
        names = [one["name"] for one in wizard_of(app).draft.reflectors]
        assert names == ["P1", "P2", "P3", "P4"]
        assert wizard_of(app).draft.reflectors[-1] == {
            "name": "P4",
            "x_mm": "12",
            "y_mm": "-3",
            "facing_deg": "",
        }
        await pilot.press("ctrl+y")
        await pilot.pause()
        assert [one["name"] for one in wizard_of(app).draft.reflectors] == ["P1", "P2", "P3"]


async def test_a_device_test_that_fails_says_why() -> None:
    app, _ = first_start()
    answer = json.dumps({"error": "the port is taken", "exit_code": 3})
    work_of(app).outcomes["doctor"] = Done((), 3, answer, "catseye: the port is taken")
    async with app.run_test(size=(80, 24)) as pilot:
        await begin(app, pilot)
        await to_page(app, pilot, "robot")
        await type_answer(app, pilot, "robot.endpoint", ENDPOINTS["robot.endpoint"])
        await pilot.press("ctrl+t")
        await settled_but_dialogs(app, pilot)
        assert isinstance(app.screen, DeviceTest)
        assert "the port is taken" in await shown(app, pilot)


async def test_a_device_is_asked_who_it_is() -> None:
    app, link = first_start()
    found = {
        "device": "robot",
        "endpoint": ENDPOINTS["robot.endpoint"],
        "ok": False,
        "identity": "RH-3FRH5515 F2",
        "simulated": False,
        "status": ["servo off, override 10 %"],
        "advice": ["alarm 60: reset it"],
    }
    work_of(app).outcomes["doctor"] = Done(
        (), 3, json.dumps({"cell": "x", "devices": [found]}), "catseye: no"
    )
    async with app.run_test(size=(80, 24)) as pilot:
        await begin(app, pilot)
        await to_page(app, pilot, "robot")
        await pilot.press("ctrl+t")
        await settled_but_dialogs(app, pilot)
        assert not isinstance(app.screen, DeviceTest)  # its endpoint is not known yet
        await type_answer(app, pilot, "robot.endpoint", ENDPOINTS["robot.endpoint"])
        await pilot.press("ctrl+t")
        await settled_but_dialogs(app, pilot)
        assert isinstance(app.screen, DeviceTest)
        assert work_of(app).done[-1][0] == "doctor"
        assert work_of(app).done[-1][2:] == ("--device", "robot", "--json")
        text = await shown(app, pilot)
        for part in ("RH-3FRH5515 F2", "servo off", "! alarm 60: reset it"):
            assert part in text
        # Textual passes the signals of a screen on, to its line of keys too, only while it counts as running.
        assert app.screen.is_running
        await pilot.press("c")
        assert "alarm 60" in app.clipboard
        await pilot.press("ctrl+t")
        await settled_but_dialogs(app, pilot)
        assert len(work_of(app).done) == 2
        await pilot.press("escape")
        await settled(app, pilot)
        assert [watch.on for watch in link.asked_for(Watch)] == [False, True]


async def settled_but_dialogs(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    """Wait for everything but workers that wait for a dialog."""
    for _ in range(400):
        await pilot.pause(0.005)
        busy = [one for one in app.workers if one.group in {"look", "judge"} and not one.is_finished]
        waiting = [one for one in app.workers if one.group in {"test", "save"} and not one.is_finished]
        if not busy and (not waiting or isinstance(app.screen, (DeviceTest, ConfirmDialog))):
            break
    await pilot.pause()


async def test_an_existing_file_is_not_replaced_unasked(folder: Path) -> None:
    app, _ = first_start()
    (folder / "other.toml").write_text("mine", encoding="utf-8")
    async with app.run_test(size=(80, 24)) as pilot:
        await begin(app, pilot)
        await type_answer(app, pilot, "file", "other.toml")
        give_all(app)
        await pilot.press("ctrl+s")
        await settled_but_dialogs(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        await pilot.press("escape")
        await settled(app, pilot)
        assert (folder / "other.toml").read_text(encoding="utf-8") == "mine"
        await pilot.press("ctrl+s")
        await settled_but_dialogs(app, pilot)
        await pilot.press("y")
        await settled(app, pilot)
        assert load_cell(folder / "other.toml").cell.name == "lab-7"


async def test_a_file_is_changed_and_keeps_its_comments(folder: Path) -> None:
    path = folder / "mine.toml"
    path.write_text(
        TEMPLATE.replace("# the program never drives faster", "# ask Ada first"), encoding="utf-8"
    )
    async with started({"cell": str(path)}, "setup", cell=path) as (app, pilot, link):
        await pilot.press("2")
        await settled(app, pilot)
        await to_page(app, pilot, "robot")
        await type_answer(app, pilot, "robot.override_cap_percent", "7")
        await pilot.press("ctrl+s")
        await settled_but_dialogs(app, pilot)
        await pilot.press("y")
        await settled(app, pilot)
        assert load_cell(path).cell.robot.override_cap_percent == 7
        assert "# ask Ada first" in path.read_text(encoding="utf-8")
        # The idle engine reads the file when it starts: it is started anew.
        assert link.ops[-1] == "shutdown"


async def test_a_file_whose_comments_would_be_lost_is_kept(folder: Path) -> None:
    path = folder / "mine.toml"
    start, end = TEMPLATE.index("[robot.limits_deg]"), TEMPLATE.index("[interferometer]")
    parted = TEMPLATE[:start] + TEMPLATE[end:] + "\n" + TEMPLATE[start:end]
    path.write_text(parted, encoding="utf-8")
    app = make_app(ScriptedLink({"cell": str(path)}), "setup", cell=path)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("2")
        await settled(app, pilot)
        await to_page(app, pilot, "robot")
        await type_answer(app, pilot, "robot.limits_deg.j1", "-100 100")
        await pilot.press("ctrl+s")
        await settled_but_dialogs(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        # Where its lines end depends on the name of the folder.
        assert any("cannot be kept" in str(text.content) for text in app.screen.query(Static))
        await pilot.press("y")
        await settled_but_dialogs(app, pilot)
        assert path.read_text(encoding="utf-8") == parted
        assert load_cell(folder / "mine-new.toml").cell.robot.limits_deg.j1 == [-100.0, 100.0]


async def test_a_file_that_is_no_cell_is_shown(folder: Path) -> None:
    path = folder / "mine.toml"
    path.write_text("a = 1\n", encoding="utf-8")
    app = make_app(ScriptedLink({"cell": str(path)}), "setup", cell=path)
    async with app.run_test(size=(80, 24)) as pilot:
        # The start mentions it, too.
        for _ in range(600):
            await pilot.pause(0.01)
            if isinstance(app.screen, ErrorDialog):
                break
        await pilot.press("escape")
        await pilot.press("2")
        await settled(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "not a cell file" in await shown(app, pilot)


async def test_faulty_cell_files_are_refused_and_replacing_the_engine_confirmed(
    folder: Path,
) -> None:
    path = folder / "mine.toml"
    path.write_text(TEMPLATE, encoding="utf-8")
    async with started(screen="setup") as (app, pilot, link):
        work_of(app).outcomes["config"] = failed(2, "the cell file cannot be used:\n  x.toml:3: name")
        await pilot.press("3")
        await pilot.pause()
        await pilot.press("enter")
        await settled(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "x.toml:3: name" in await shown(app, pilot)
        assert [one.op for one in link.asked if one.op == "shutdown"] == []
        del work_of(app).outcomes["config"]
        await pilot.press("escape", "3")
        await pilot.pause()
        assert isinstance(app.screen, FormDialog)
        app.screen.query_one(Input).value = str(path)
        await pilot.press("enter")
        await settled(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        await pilot.press("y")
        await settled(app, pilot)
        assert link.cell == path
        assert link.ops[-1] == "shutdown"


NO_FILES = (("adir", "is a folder"), ("", "is a folder"), ("no/cell.toml", "no folder no"))


async def test_an_invalid_file_path_is_reported_before_asking(folder: Path) -> None:
    (folder / "adir").mkdir()
    path = folder / "mine.toml"
    path.write_text(TEMPLATE, encoding="utf-8")
    app = make_app(ScriptedLink({"cell": str(path)}), "setup", cell=path)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("2")
        await settled(app, pilot)
        for file, message in NO_FILES:
            await type_answer(app, pilot, "file", file)
            await pilot.press("ctrl+s")
            await settled_but_dialogs(app, pilot)
            assert isinstance(app.screen, ErrorDialog), file
            assert message in await shown(app, pilot), file
            await pilot.press("escape")


async def test_unfinished_changes_and_new_files_are_kept_apart(folder: Path) -> None:
    path = folder / "mine.toml"
    path.write_text(TEMPLATE, encoding="utf-8")
    app = make_app(ScriptedLink({"cell": str(path)}), "setup", cell=path)
    async with app.run_test(size=(80, 24)) as pilot:
        for key, name in (("1", "lab-7"), ("2", "lab-8")):
            await pilot.press(key)
            await settled(app, pilot)
            await type_answer(app, pilot, "name", name)
            await pilot.press("pagedown", "pageup", "escape")
        assert "half-way: 1 2 continues with them" in await shown(app, pilot)
        for key, name, file in (("1", "lab-7", "cell.toml"), ("2", "lab-8", str(path))):
            await pilot.press(key)
            await settled(app, pilot)
            draft = wizard_of(app).draft
            assert (draft.answer("name"), draft.answer("file")) == (name, file)
            await pilot.press("escape")
        # Somebody mends the file with an editor: what was asked about it before would undo that.
        path.write_text(f"{TEMPLATE}# mended\n", encoding="utf-8")
        await pilot.press("2")
        await settled(app, pilot)
        assert wizard_of(app).draft.answer("name") == "lab-1"
