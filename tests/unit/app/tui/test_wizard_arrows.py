"""Going through the questions of the wizard by arrows, and leaving them half-way."""

from pathlib import Path

import pytest
from textual.widgets import Select

from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.setup.question_row import QuestionRow
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> CatseyeApp:
    monkeypatch.chdir(tmp_path)
    link = ScriptedLink()
    link.engine.lost("there is no cell file yet")
    link.cell = None
    made = make_app(link, "setup")
    made.session.cell = None
    return made


def key_in_focus(app: CatseyeApp) -> str:
    assert app.focused is not None
    row = next(each for each in app.focused.ancestors if isinstance(each, QuestionRow))
    return row.question.key


async def test_down_skips_a_closed_select_and_enter_opens_it(app: CatseyeApp) -> None:
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("1")
        await shown(app, pilot)
        await pilot.press("ctrl+n")
        await shown(app, pilot)
        assert key_in_focus(app) == "robot.driver"
        await pilot.press("down")
        await shown(app, pilot)
        assert key_in_focus(app) == "robot.endpoint"
        await pilot.press("up")
        await shown(app, pilot)
        await pilot.press("enter")
        assert app.screen.query(Select).first().expanded


async def test_only_unfinished_questions_can_be_continued(app: CatseyeApp) -> None:
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("1")
        await shown(app, pilot)
        await pilot.press("escape")
        assert "left half-way: 1 continues with them" in await shown(app, pilot)
