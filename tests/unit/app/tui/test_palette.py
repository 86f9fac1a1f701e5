"""The palette before anything is typed."""

from pathlib import Path

import pytest
from textual.command import CommandPalette

from catseye.app.tui.login import Login
from catseye.app.tui.main_screens import MAIN_SCREENS
from tests.unit.app.tui.scripted import shown, started
from tests.unit.app.tui.scripted_run import MOTION, SNAPSHOT, ask
from tests.unit.app.tui.test_login import cell as controller_elsewhere


async def test_log_in_again_forgets_the_password(tmp_path: Path) -> None:
    environment = {"CATSEYE_ABB_USER": "somebody", "CATSEYE_ABB_PASSWORD": "wrong"}
    async with started(SNAPSHOT, "setup") as (app, pilot, _):
        app.session.cell, app.session.login = controller_elsewhere(tmp_path), Login(environment)
        commands = app.get_system_commands(app.screen)
        next(one for one in commands if one.title == "Log in again").callback()
        for _ in range(50):
            await pilot.pause(0.02)
            if not environment:
                break
        assert environment == {}


@pytest.mark.parametrize("screen", MAIN_SCREENS)
async def test_enter_alone_changes_nothing(screen: str) -> None:
    async with started(SNAPSHOT, screen) as (app, pilot, link):
        ask(link, **MOTION)
        await pilot.press("ctrl+p")
        for _ in range(20):
            text = await shown(app, pilot)
            if "Go to Bench" in text:
                break
            await pilot.pause(0.05)
        assert isinstance(app.screen, CommandPalette)
        await pilot.press("enter")
        await pilot.pause()
        await shown(app, pilot)
        assert app.current_mode == "bench"
        # Of the screen Terminal: it looks at the traffic while it is shown.
        assert [request for request in link.asked if request.op != "traffic"] == []
