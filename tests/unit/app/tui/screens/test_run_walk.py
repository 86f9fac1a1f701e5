"""The run screen while a plan is walked through."""

from textual.pilot import Pilot

from catseye.app.protocol.requests import WalkFeed
from tests.unit.app.tui.screens.run_screen import ops, run_screen, settled
from tests.unit.app.tui.scripted import ScriptedLink
from tests.unit.app.tui.scripted_run import SNAPSHOT

WALK = {**SNAPSHOT, "procedure": "walk", "title": "Walk-through of open-loop"}


async def hold(pilot: Pilot[int], link: ScriptedLink) -> None:
    await pilot.press("space")
    link.now_s += 0.5
    await pilot.press("space")
    await pilot.pause()


async def test_holding_space_feeds_a_walk() -> None:
    async with run_screen(WALK) as (app, pilot, link):
        text = await settled(app, pilot, link)
        assert "hold Space" in text
        assert "not an enabling device" in text
        await pilot.press("space")
        assert "walk-feed" not in ops(link)
        link.now_s += 0.5
        await pilot.press("space")
        await pilot.pause()
        assert WalkFeed() in link.asked


async def test_another_screen_lets_go() -> None:
    async with run_screen(WALK) as (app, pilot, link):
        await settled(app, pilot, link)
        await hold(pilot, link)
        await pilot.press("f3")
        await pilot.pause()
        assert WalkFeed(on=False) in link.asked


async def test_a_walk_under_somebody_elses_control_is_not_fed() -> None:
    async with run_screen({**WALK, "control": {"client": "tui-9", "who": "Ben"}}) as (app, pilot, link):
        await settled(app, pilot, link)
        await hold(pilot, link)
        assert "walk-feed" not in ops(link)


async def test_space_means_nothing_to_a_measurement() -> None:
    async with run_screen() as (app, pilot, link):
        await settled(app, pilot, link)
        await hold(pilot, link)
        assert "walk-feed" not in ops(link)
