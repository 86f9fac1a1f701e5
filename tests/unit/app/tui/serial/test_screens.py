"""Bench and Jog of an arm that is no SCARA: looks, and what keys move."""

from typing import Any

import pytest
from textual.pilot import Pilot

from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.requests import JogHold, JogStep
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.bench_view import BenchView
from catseye.app.tui.dialogs.questions import MotionDialog
from catseye.app.tui.jog_text import STEPS_ONLY
from catseye.app.tui.screens.jog import JogScreen
from tests.patience import until
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, shown, started
from tests.unit.app.tui.scripted_bench import publish_strip
from tests.unit.app.tui.serial.scripted_arm import arm_bench, tracker_bench

SIZES = [(80, 24), (120, 40), (160, 50)]
AT_MM = 0.523572193
MINE = {"on": True, "by": "Ada (tui-1)", "percent": 5.0, "moving": None}


@pytest.mark.parametrize("size", SIZES)
async def test_bench_looks(size: tuple[int, int]) -> None:
    async with started(size=size) as (app, pilot, link):
        link.publish("bench", **arm_bench())
        publish_strip(link, at_mm=AT_MM)
        await shown(app, pilot)
        assert not changed_screen(f"bench-arm-{size[0]}x{size[1]}", await shown(app, pilot))


@pytest.mark.parametrize("size", SIZES[:2])
async def test_bench_of_a_tracker_looks(size: tuple[int, int]) -> None:
    async with started(size=size) as (app, pilot, link):
        link.publish("bench", **tracker_bench())
        await shown(app, pilot)
        text = await shown(app, pilot)
        assert "beam" not in text.lower()
        assert "air sensor" not in text
        assert not changed_screen(f"bench-tracker-{size[0]}x{size[1]}", text)


async def test_a_tracker_without_nests_is_warned_of() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        status = tracker_bench()
        status["instrument"]["nests"] = []
        link.publish("bench", **status)
        await shown(app, pilot)
        assert "no nests: a drift cannot be seen" in await shown(app, pilot)


async def test_an_air_sensor_beside_a_tracker_is_shown() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        status = tracker_bench(air=arm_bench()["air"])
        status["devices"].append(arm_bench()["devices"][2])
        link.publish("bench", **status)
        await shown(app, pilot)
        assert "20.12 °C" in await shown(app, pilot)


async def test_the_strip_is_in_the_unit_of_the_optics() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **arm_bench())
        # 30 mm x sin 1 deg, and a micrometre more: 1.9102e-3 deg.
        ends = {"low": [AT_MM, AT_MM], "high": [AT_MM, AT_MM + 1e-3], "count": [4, 4]}
        link.publish("samples", quantity="displacement_mm", period_s=0.02, missed=0, **ends)
        text = await shown(app, pilot)
        assert "Beam as angle, S = 30 mm" in text
        assert "range 1.910 mdeg" in text
        assert "1.000 000 deg" in text
        await pilot.press("u")
        text = await shown(app, pilot)
        assert "range 1.0 µm" in text
        assert "0.523 572 mm" in text


async def begin_jog(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink, moving: str | None = None) -> str:
    """Have this client jog the arm; return the screen."""
    link.publish("bench", **arm_bench())
    publish_strip(link, at_mm=AT_MM)
    link.engine.control = Client(client="tui-1", who="Ada")
    link.publish("jog", **{**MINE, "moving": moving})
    await shown(app, pilot)
    return await shown(app, pilot)


@pytest.mark.parametrize("size", SIZES)
async def test_jog_looks(size: tuple[int, int]) -> None:
    async with started(screen="jog", size=size) as (app, pilot, link):
        assert not changed_screen(f"jog-arm-{size[0]}x{size[1]}", await begin_jog(app, pilot, link, "a3"))


async def test_jog_without_interferometer_gives_the_beams_room_to_the_arm() -> None:
    async with started(screen="jog", size=(160, 50)) as (app, pilot, link):
        link.publish("bench", **arm_bench())
        assert "─ Beam" in await shown(app, pilot)
        link.publish("bench", **tracker_bench())
        text = await shown(app, pilot)
        assert "─ Beam" not in text
        assert "From the side, from above" in text


async def test_the_small_screen_shows_the_arm_by_a_key() -> None:
    async with started() as (app, pilot, link):
        link.publish("bench", **arm_bench())
        await shown(app, pilot)
        await pilot.press("v")
        text = await shown(app, pilot)
        assert "From the side" in text
        assert "BEAM OK" not in text
        link.publish("bench", **arm_bench(None))
        assert "the position of the arm is not" in await shown(app, pilot)


async def test_an_old_posture_is_greyed() -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **arm_bench())
        await shown(app, pilot)
        link.now_s += 7.0
        assert "arm as it was: old" in await shown(app, pilot)
        assert all("dim" in str(span.style) for span in app.screen.query_one(BenchView).shown.spans)


async def test_keys_choose_an_axis_and_step_it() -> None:
    async with started(screen="jog") as (app, pilot, link):
        await begin_jog(app, pilot, link)
        for keys, joint, by in (
            (("right",), "a1", 0.1),
            (("down", "s", "a"), "a3", -0.1),
            (("up", "3", "d"), "a2", 1.0),
            (("w", "w", "left"), "a6", -1.0),
        ):
            await pilot.press(*keys)
            await pilot.pause()
            assert link.asked[-1] == JogStep(joint=joint, by=by)
            assert f"▸ {joint.upper()}" in await shown(app, pilot)


async def test_keys_of_a_beam_move_nothing_on_other_arms() -> None:
    async with started(screen="jog") as (app, pilot, link):
        await begin_jog(app, pilot, link)
        await pilot.press("q", "e", "z", "x", "n", "p")
        await pilot.pause()
        assert link.asked == []
        assert not isinstance(app.screen, MotionDialog)


async def test_an_arm_without_jog_moves_by_steps_only() -> None:
    async with started(screen="jog") as (app, pilot, link):
        text = await begin_jog(app, pilot, link)
        assert STEPS_ONLY in text
        await pilot.press("m", "right")
        await pilot.pause()
        assert link.asked_for(JogHold) == []
        assert link.asked_for(JogStep) == [JogStep(joint="a1", by=0.1)]


async def test_a_key_is_held_where_the_driver_can_jog() -> None:
    async with started(screen="jog") as (app, pilot, link):
        await begin_jog(app, pilot, link)
        status = arm_bench()
        link.publish("bench", **{**status, "robot": {**status["robot"], "jogs": True}})
        await pilot.press("m", "right")
        await pilot.pause()
        assert link.asked == []
        link.now_s += 0.5
        await pilot.press("right")
        await until(lambda: bool(link.asked))
        assert link.asked[0] == JogHold(joint="a1", direction=1)
        await pilot.press("down")


async def test_every_axis_is_stepped_from_the_palette_after_f8() -> None:
    async with started(screen="jog") as (app, pilot, link):
        await begin_jog(app, pilot, link)
        assert isinstance(app.screen, JogScreen)
        callbacks = {command.title: command.callback for command in app.screen.commands()}
        assert {f"One step: A{number} {sign}" for number in range(1, 7) for sign in "+−"} <= callbacks.keys()
        assert "Next aim" not in callbacks
        callbacks["One step: A5 −"]()
        text = await shown(app, pilot)
        assert "A5 − by 0.1 deg" in text
        assert "A5 by 0.10°" in text
        assert "override   5 %, at most 20 %" in text
        await pilot.press("enter")
        await pilot.pause()
        assert link.asked == []
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked == [JogStep(joint="a5", by=-0.1)]
