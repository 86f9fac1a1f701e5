"""What is asked of the engine while the key of a walk is held and let go."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from catseye.app.protocol.requests import WalkFeed
from catseye.app.tui.walk_feeder import WalkFeeder
from tests.unit.app.tui.scripted import ScriptedLink

FED = WalkFeed()
LET_GO = WalkFeed(on=False)


class Rig:
    """A feeder on a scripted engine, on a clock that a test moves."""

    def __init__(self) -> None:
        self.link = ScriptedLink()
        self.failures: list[str] = []
        self.naps = asyncio.Event()
        self.feeder = WalkFeeder(self.link, lambda: self.link.now_s, self.failures.append, self._nap)

    async def pass_time(self, by_s: float) -> None:
        self.link.now_s += by_s
        self.naps.set()
        self.naps = asyncio.Event()
        for _ in range(20):
            await asyncio.sleep(0)

    async def hold(self) -> None:
        self.feeder.press()
        await self.pass_time(0.5)
        self.feeder.press()
        await self.pass_time(0.0)

    async def _nap(self, _: float) -> None:
        await self.naps.wait()


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    made = Rig()
    yield made
    made.feeder.let_go()
    await made.pass_time(0.0)


async def test_a_key_that_has_not_repeated_feeds_nothing(rig: Rig) -> None:
    rig.feeder.press()
    await rig.pass_time(0.5)
    assert rig.link.asked == []


async def test_a_held_key_feeds_until_it_repeats_no_more(rig: Rig) -> None:
    await rig.hold()
    for _ in range(4):
        await rig.pass_time(0.05)
        rig.feeder.press()
    assert set(map(str, rig.link.asked)) == {str(FED)}
    for _ in range(8):
        await rig.pass_time(0.05)
    assert rig.link.asked[-1] == LET_GO
    assert rig.link.asked.count(LET_GO) == 1
    assert not rig.feeder.held


async def test_letting_go_stops_at_once(rig: Rig) -> None:
    await rig.hold()
    rig.feeder.let_go()
    await rig.pass_time(0.0)
    assert rig.link.asked[-1] == LET_GO


async def test_a_refusal_is_reported_once_and_ends_it(rig: Rig) -> None:
    rig.link.refusals["walk-feed"] = "this needs control"
    await rig.hold()
    for _ in range(3):
        await rig.pass_time(0.05)
        rig.feeder.press()
    assert rig.failures == ["this needs control"]
    assert rig.link.asked.count(FED) == 1
