"""Keys that work everywhere, and the ways out."""

from typing import Any

import pytest
from textual.widgets import Input

from app.tui.dialogs.error_dialog import ErrorDialog
from app.tui.dialogs.quit_dialog import QuitDialog
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown

RUN = {
    "run": "20261121T090000Z_open-loop_abc123",
    "procedure": "open-loop",
    "title": "Open loop",
    "state": "EXECUTE",
}


def ops(link: ScriptedLink) -> list[str]:
    return [str(request["op"]) for request in link.asked]


@pytest.mark.parametrize("dialog", [False, True])
async def test_stop_key_reaches_the_engine(dialog: bool) -> None:
    link = ScriptedLink(RUN)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        if dialog:
            app.push_screen(ErrorDialog("Something", "went wrong: try again"))
        await pilot.press("f12")
        await pilot.pause()
        assert ops(link) == ["stop"]


async def test_stop_key_works_in_the_palette_and_in_an_input() -> None:
    link = ScriptedLink(RUN)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+p")
        await pilot.pause()
        assert app.screen.query(Input)
        await pilot.press("f12")
        await pilot.pause()
        assert ops(link) == ["stop"]


async def test_ctrl_c_climbs_the_ladder() -> None:
    link = ScriptedLink(RUN)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        for state, asked in (("EXECUTE", "hold"), ("HELD", "stop"), ("STOPPING", "abort")):
            link.tell("state", run=RUN["run"], state=state, reason="")
            await pilot.press("ctrl+c")
            await pilot.pause()
            assert ops(link)[-1] == asked


async def test_refusal_is_told_with_its_remedy() -> None:
    link = ScriptedLink(RUN)
    link.refusals["hold"] = "the devices are being connected and nothing moves: hold when it runs, or stop"
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("h")
        text = await shown(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "→ hold when it runs, or stop" in text


@pytest.mark.parametrize(("key", "asked", "ends"), [("l", [], False), ("h", ["hold"], False)])
async def test_quitting_asks_while_a_run_is_under_way(key: str, asked: list[str], ends: bool) -> None:
    link = ScriptedLink(RUN)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+q")
        await pilot.pause()
        assert isinstance(app.screen, QuitDialog)
        await pilot.press(key)
        await pilot.pause()
        assert ops(link) == asked
        assert link.left == [ends]


async def test_quitting_with_stop_waits_for_the_end_of_the_run() -> None:
    link = ScriptedLink(RUN)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+q", "s")
        await pilot.pause()
        assert ops(link) == ["stop"]
        assert link.left == []
        ended: dict[str, Any] = {"status": "stopped", "exit_code": 5, "text": "", "path": "/bench"}
        link.tell("run-ended", **{**ended, "run": RUN["run"]})
        await pilot.pause()
        assert link.left == [True]


async def test_quitting_at_once_when_nothing_runs() -> None:
    link = ScriptedLink()
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+q")
        await pilot.pause()
        assert link.left == [True]


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
@pytest.mark.parametrize("key", ["f2", "f3", "f4", "f5", "f6", "f7", "f9", "f10"])
async def test_each_place_has_stop_in_sight(size: tuple[int, int], key: str) -> None:
    app = make_app(ScriptedLink())
    async with app.run_test(size=size) as pilot:
        await pilot.press(key)
        text = await shown(app, pilot)
        assert "STOP F12" in text
        assert "no emergency stop" in text
