"""The controller's alarm: an unmet need, and reset by a key once its text was shown."""

from typing import Any

import pytest

from catseye.app.protocol.requests import ResetAlarm
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, make_app, shown, started
from tests.unit.app.tui.scripted_bench import bench

TEXT = "alarm L2600: position data outside of the range; check the target against the joint limits"
ALARM = {"alarm_number": 2600, "alarm_text": TEXT}


@pytest.mark.parametrize("screen", ["bench", "jog"])
@pytest.mark.parametrize("key", ["y", "escape", "enter", "f8"])
async def test_only_y_resets_what_was_shown(screen: str, key: str) -> None:
    async with started(screen=screen) as (app, pilot, link):
        link.publish("bench", **bench(robot=ALARM))
        assert "2600" in await shown(app, pilot)
        await pilot.press("exclamation_mark")
        text = await shown(app, pilot)
        assert "Reset alarm 2600?" in text
        assert "position data outside of the range" in text
        await pilot.press(key)
        await shown(app, pilot)
        asked = [ResetAlarm(number=2600, text=TEXT)] if key == "y" else []
        assert link.asked_for(ResetAlarm) == asked


async def test_the_request_names_the_alarm_that_was_read() -> None:
    link = ScriptedLink()
    link.refusals["reset-alarm"] = "the controller is in another alarm by now, 50: external emergency stop"
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        link.publish("bench", **bench(robot=ALARM))
        await shown(app, pilot)
        await pilot.press("exclamation_mark")
        link.publish("bench", **bench(robot={"alarm_number": 50, "alarm_text": "external emergency stop"}))
        await pilot.press("y")
        text = await shown(app, pilot)
        assert link.asked_for(ResetAlarm)[0].number == 2600
        assert isinstance(app.screen, ErrorDialog)
        assert "another alarm by now" in text


@pytest.mark.parametrize("alarm", [{"alarm_number": -7}, {"alarm_text": "a" * 1001}])
async def test_an_alarm_that_fits_no_request_is_said(alarm: dict[str, Any]) -> None:
    async with started() as (app, pilot, link):
        link.publish("bench", **bench(robot={**ALARM, **alarm}))
        await shown(app, pilot)
        await pilot.press("exclamation_mark")
        await shown(app, pilot)
        await pilot.press("y")
        assert "The alarm is not reset" in await shown(app, pilot)
        assert link.asked == []


async def test_an_alarm_of_the_pendant_is_only_shown() -> None:
    async with started() as (app, pilot, link):
        link.publish("bench", **bench(robot={**ALARM, "resets_alarms": False}))
        assert "! resets it" not in await shown(app, pilot)
        await pilot.press("exclamation_mark")
        assert "confirmed at the controller's pendant" in await shown(app, pilot)
        await pilot.press("y", "escape")
        assert link.asked == []


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
async def test_the_dialog_of_an_alarm(size: tuple[int, int]) -> None:
    async with started(size=size) as (app, pilot, link):
        link.publish("bench", **bench(robot=ALARM))
        assert "! resets it" in " ".join((await shown(app, pilot)).split())
        await pilot.press("exclamation_mark")
        assert not changed_screen(f"bench-alarm-{size[0]}x{size[1]}", await shown(app, pilot))
