"""Values that the controller gives no number for take no screen down."""

from typing import Any

import pytest

from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.main_screens import MAIN_SCREENS
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown, started, work_of
from tests.unit.app.tui.scripted_bench import bench
from tests.unit.app.tui.scripted_run import MOTION, REHEARSAL, SNAPSHOT, ask, measure

NO_NUMBERS = {"override_percent": None, "joints": [None, 60.0, None, 0.0]}
NOTHING = {"override_percent": None, "joints": None}


@pytest.mark.parametrize("robot", [NO_NUMBERS, NOTHING], ids=["some", "none"])
async def test_every_screen_shows_values_that_are_null(robot: dict[str, Any]) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = make_app(link)
    work_of(app).outcomes["run"] = REHEARSAL
    async with app.run_test(size=(120, 40)) as pilot:
        link.publish("bench", **bench(robot=robot, beam={"signal": None, "displacement_mm": None}))
        measure(link)
        ask(link, **{**MOTION, "target": None, "override_percent": None, "speed_deg_s": None})
        for name, entry in MAIN_SCREENS.items():
            await pilot.press(entry.key)
            text = await shown(app, pilot)
            assert not isinstance(app.screen, ErrorDialog), (name, text)
            assert "servo off —" in text


@pytest.mark.parametrize("robot", [NO_NUMBERS, NOTHING], ids=["some", "none"])
async def test_a_jog_shows_values_that_are_null(robot: dict[str, Any]) -> None:
    controlled = {"control": {"client": "tui-1", "who": "Ada"}}
    async with started(controlled, "jog", size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **bench(robot=robot))
        link.publish("jog", on=True, by="Ada (tui-1)", percent=None, moving=None)
        assert "JOG —" in await shown(app, pilot)
        await pilot.press("n", "p")
        assert "too old" in await shown(app, pilot)
        assert not isinstance(app.screen, ErrorDialog)
