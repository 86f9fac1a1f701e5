"""A panel that fills the screen, and the way back."""

import pytest

from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.widgets.bars import StopBar
from tests.unit.app.tui.screens.run_screen import run_screen
from tests.unit.app.tui.scripted import settled, started
from tests.unit.app.tui.scripted_bench import bench
from tests.unit.app.tui.scripted_run import MOTION, ask, publish


@pytest.mark.parametrize("size", [(80, 24), (200, 60)])
async def test_the_focused_panel_fills_the_screen_and_shrinks(size: tuple[int, int]) -> None:
    async with started(size=size) as (app, pilot, link):
        link.publish("bench", **bench())
        await settled(app, pilot)
        screen = app.screen
        assert isinstance(screen, MainScreen)
        panel = screen.query_one("#robot")
        before = panel.size
        screen._enlarge(panel)  # noqa: SLF001  # as the palette does
        text = await settled(app, pilot)
        # State above, HOLD, STOP and ABORT below stay.
        assert panel.outer_size == (size[0], size[1] - 5)
        assert screen.query_one(StopBar).region.height == 1
        assert "STOP F12" in text
        assert "back to the screen" in text
        await pilot.press("ctrl+l")
        text = await settled(app, pilot)
        assert panel.size == before
        assert "back to the screen" not in text


async def test_a_question_of_the_run_uncovers_the_screen() -> None:
    async with run_screen() as (app, pilot, link):
        await settled(app, pilot)
        await pilot.press("ctrl+l")
        assert app.screen.maximized is not None
        ask(link, **MOTION)
        await settled(app, pilot)
        assert app.screen.maximized is None


async def test_nothing_covers_an_open_question() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot)
        await pilot.press("ctrl+l")
        text = await settled(app, pilot)
        assert app.screen.maximized is None
        assert MOTION["text"][:30] in text
        screen = app.screen
        assert isinstance(screen, MainScreen)
        for command in screen.enlarging():
            command.callback()
            assert app.screen.maximized is None


async def test_the_same_question_asked_anew_uncovers_the_screen() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot)
        publish(link, "answer", id="stage/1", answer="no", who="Ada")
        await pilot.press("ctrl+l")
        assert app.screen.maximized is not None
        ask(link, **MOTION)
        await settled(app, pilot)
        assert app.screen.maximized is None
