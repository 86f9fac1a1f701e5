"""The screen Set-up: from nothing to a cell file of a serial arm that a tracker calibrates, and wrong answers."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.widgets import Input, Select

from catseye.app.cell.load import load_cell
from catseye.app.cell.templates import SIX_AXIS
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.session import EMULATED_TRACKER
from catseye.app.tui.setup.emulators import emulated_cell, free_file, is_emulated
from catseye.app.tui.setup.question_row import QuestionRow
from catseye.app.tui.setup.wizard import Wizard
from tests.unit.app.tui.screens.test_setup import begin, first_start, judged, to_page, type_answer
from tests.unit.app.tui.scripted import changed_screen, settled

SIZES = [(80, 24), (120, 40)]
ANSWERS = {
    "robot.endpoint": "tcp://192.168.125.1:80",
    "tracker.endpoint": "tcp://192.168.0.1:700",
    "tracker.base_mm": "-1800, 300, -350",
    "tracker.base_deg": "0, 0, 12.5",
    "tracker.nest.0": "-1450, -50, -330",
    "tracker.nest.1": "-1450, 650, -330",
    "tracker.nest.2": "-2150, 650, -330",
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@asynccontextmanager
async def asked(size: tuple[int, int] = (80, 24)) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any], Wizard]]:
    """Show the questions of a six-axis cell with a name."""
    app, _ = first_start()
    async with app.run_test(size=size) as pilot:
        wizard = await begin(app, pilot)
        await type_answer(app, pilot, "name", "irb-3")
        row = next(row for row in app.screen.query(QuestionRow) if row.question.key == "system")
        row.query_one(Select).value = SIX_AXIS
        await settled(app, pilot)
        yield app, pilot, wizard


def give(wizard: Wizard, answers: dict[str, str]) -> None:
    for key, answer in answers.items():
        wizard.draft.give(key, answer)


@pytest.mark.parametrize("size", SIZES)
async def test_pages_of_arm_tracker_and_ballbar(size: tuple[int, int]) -> None:
    async with asked(size) as (app, pilot, wizard):
        for page in ("robot", "tracker", "ballbar", "summary"):
            await to_page(app, pilot, page)
            # The cursor blinks by a clock of its own.
            for field in app.screen.query(Input):
                field.cursor_blink = False
            text = await judged(app, pilot)
            assert not changed_screen(f"setup_six_axis_{page}_{size[0]}x{size[1]}", text)
        give(wizard, ANSWERS)
        await to_page(app, pilot, "tracker")
        for field in app.screen.query(Input):
            field.cursor_blink = False
        text = await judged(app, pilot)
        assert not changed_screen(f"setup_six_axis_tracker_answered_{size[0]}x{size[1]}", text)


async def test_answers_become_a_cell(folder: Path) -> None:
    async with asked() as (app, pilot, wizard):
        give(wizard, ANSWERS)
        await to_page(app, pilot, "summary")
        assert "all checks passed" in await judged(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
    cell = load_cell(folder / "cell.toml").cell
    assert (cell.name, cell.robot.driver, cell.robot.arm) == ("irb-3", "abb-rws", "irb120")
    assert cell.tracker is not None
    assert list(cell.tracker.base_deg or ()) == [0.0, 0.0, 12.5]
    assert [nest.x_mm for nest in cell.tracker.nest] == [-1450.0, -1450.0, -2150.0]


@pytest.mark.parametrize(
    ("page", "key", "typed", "said"),
    [
        ("tracker", "tracker.base_mm", "-1800, 300", "give 3 values, not 2: [-1800, 300]"),
        ("tracker", "tracker.base_mm", "-1,8; 0,3; -0,35", "give 3 values, not 6"),
        ("tracker", "tracker.base_deg", "upright", "a valid number, not 'upright'"),
        ("tracker", "tracker.cone_deg", "200", "less than or equal to 90"),
        ("tracker", "tracker.nest.1", "-1450, 650", "give three numbers"),
        ("tracker", "tracker.nest.2", "-1450, 1350, -330", "the nests W1, W2, W3 lie on a line"),
        ("robot", "robot.tool", "no-such-plate", "there is no description of a tool no-such-plate"),
        ("robot", "robot.override_cap_percent", "120", "less than or equal to 100"),
        ("ballbar", "ballbar.length_mm", "-300", "greater than 0"),
        ("ballbar", "ballbar.centre_mm", "500, 0", "give 3 values, not 2: [500, 0]"),
    ],
)
async def test_wrong_answers_are_marked(page: str, key: str, typed: str, said: str, folder: Path) -> None:
    async with asked((120, 40)) as (app, pilot, wizard):
        give(wizard, {**ANSWERS, key: typed})
        await to_page(app, pilot, page)
        text = await judged(app, pilot)
        assert said in " ".join(text.split())
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        assert not (folder / "cell.toml").exists()


def test_the_emulated_tracker_has_a_cell_file_of_its_own(folder: Path) -> None:
    path = free_file(folder, SIX_AXIS)
    assert path.name == f"{EMULATED_TRACKER}.toml"
    path.write_text(emulated_cell(SIX_AXIS), encoding="utf-8")
    assert is_emulated(path, SIX_AXIS)
    cell = load_cell(path).cell
    assert cell.tracker is not None
    places = {cell.robot.endpoint, cell.tracker.endpoint, cell.tracker.control}
    assert len({str(place).rpartition(":")[2] for place in places} - {"8080", "10700", "10099"}) == 3
