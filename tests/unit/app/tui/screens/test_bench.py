"""The screen Bench: looks, keys, what is stale, lost or wrong."""

import subprocess
import sys
from typing import Any

import pytest

from catseye.app.tui.bench_view import BenchView
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.screens.bench import BenchScreen
from catseye.app.tui.widgets.beam_panel import BeamPanel
from catseye.app.tui.widgets.strip import Strip
from tests.unit.app.tui.scripted import changed_screen, shown, started
from tests.unit.app.tui.scripted_bench import BENCH, bench, publish_strip

SIZES = [(80, 24), (120, 40)]

LOST = bench(
    robot={
        "alarm_number": 2165,
        "alarm_text": "alarm H2165: joint limit reached upwards, J5; jog the joint back, then reset the alarm",
    },
    beam={"beam_ok": False, "beam_lost": True, "signal": 0.03},
    door_closed=False,
)
LOST["devices"][2].update(link="lost", error="no answer within 1 s: check cable and power", age_s=42.0)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(("name", "status"), [("well", BENCH), ("lost", LOST)])
async def test_looks(size: tuple[int, int], name: str, status: dict[str, Any]) -> None:
    async with started(size=size) as (app, pilot, link):
        link.publish("bench", **status)
        publish_strip(link)
        await shown(app, pilot)
        assert not changed_screen(f"bench-{name}-{size[0]}x{size[1]}", await shown(app, pilot))


async def test_the_bench_screen_changes_strip_length_and_view() -> None:
    async with started() as (app, pilot, link):
        assert not changed_screen("bench-nothing-80x24", await shown(app, pilot))
        link.publish("bench", **BENCH)
        publish_strip(link)
        strip = app.screen.query_one(Strip)
        for window_s in (30, 60, 10):
            await pilot.press("comma")
            assert strip.window_s == window_s
        assert "−10." in await shown(app, pilot)
        # The bench from above takes the place of the beam on a small screen.
        await pilot.press("v")
        text = await shown(app, pilot)
        assert "From above" in text
        assert "── beam ok → P1" in text
        assert "BEAM OK" not in text
        await pilot.press("v")
        assert "BEAM OK" in await shown(app, pilot)
        # Each action stands in the palette.
        assert isinstance(app.screen, BenchScreen)
        for command in app.screen.commands():
            command.callback()
        assert app.screen.has_class("plan")
        assert app.screen.query_one(BeamPanel).query_one(Strip).window_s == 30


async def test_other_sizes_and_changes_of_size() -> None:
    async with started() as (app, pilot, link):
        link.publish("bench", **BENCH)
        publish_strip(link)
        for size in ((60, 20), (100, 30), (200, 60), (20, 8), (160, 24)):
            await pilot.resize_terminal(*size)
            await pilot.press("v")
            text = await shown(app, pilot)
            assert "robot" in text
            assert max(map(len, text.splitlines())) <= size[0]


async def test_device_details_can_be_copied_while_values_arrive() -> None:
    async with started() as (app, pilot, link):
        link.publish("bench", **BENCH)
        await shown(app, pilot)
        await pilot.press("down")
        link.now_s += 3.0
        link.publish("bench", **LOST)
        await shown(app, pilot)
        await pilot.press("enter")
        assert "line-counter" in await shown(app, pilot)
        await pilot.press("escape", "down", "enter")
        text = await shown(app, pilot)
        assert isinstance(app.screen, TextDialog)
        assert "no answer within 1 s: check cable and power" in text
        assert "tcp://127.0.0.1:10502" in text
        await pilot.press("c")
        assert "no answer within 1 s" in app.clipboard
        await pilot.press("escape")
        assert isinstance(app.screen, BenchScreen)
        await pilot.press("up", "up", "enter")
        assert "H2165" in await shown(app, pilot)


async def test_stale_values_are_greyed_and_a_missing_engine_explained() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **BENCH)
        publish_strip(link)
        await shown(app, pilot)
        link.now_s += 7.0
        text = await shown(app, pilot)
        assert text.count("old)") >= 4
        assert "arm as it was: old" in text
        assert all("dim" in str(span.style) for span in app.screen.query_one(Strip).shown.spans)
        assert all("dim" in str(span.style) for span in app.screen.query_one(BenchView).shown.spans)
        link.publish("bench", **BENCH)
        assert "BEAM OK" in await shown(app, pilot)
        link.engine.lost("the engine is gone; looking for it")
        text = await shown(app, pilot)
        assert "the engine is gone; looking for it" in text
        assert "no robot answers" in text
        assert "BEAM OK" not in text


FIRST_SCREEN = """
import asyncio, sys
from pathlib import Path
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.session import Session
from catseye.app.service.command_process import Commands

class NoEngineYet:
    engine, cell = EngineState(), None

    async def serve(self, changed):
        changed()
        await asyncio.Event().wait()

async def show():
    app = CatseyeApp(Session(NoEngineYet(), Commands(), Path("runs"), None, lambda: 0.0), screen=sys.argv[1])
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause()
        app.screen.show_now()
        await pilot.pause()
        assert app.screen.query("StopBar")
        print([name for name in ("numpy", "scipy", "pydantic") if name in sys.modules])

asyncio.run(show())
"""


@pytest.mark.parametrize("screen", ["bench", "setup"])
def test_the_first_screen_loads_no_slow_modules(screen: str) -> None:
    command = [sys.executable, "-c", FIRST_SCREEN, screen]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
