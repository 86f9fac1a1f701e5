"""What is asked of the engine while keys are held, stepped and let go."""

import asyncio
from collections.abc import AsyncIterator, Callable

import pytest

from catseye.app.protocol.requests import AnyRequest, JogHold, JogStep, Plain
from catseye.app.service.errors import RefusedError
from catseye.app.tui.jog_client import JogClient, Step
from tests.unit.app.tui.scripted import ScriptedLink


class Rig:
    """JogClient on a scripted engine, on a clock that a test moves."""

    def __init__(self, *, answers_steps: bool = True) -> None:
        self.link = ScriptedLink()
        self.failures: list[str] = []
        self.stands = asyncio.Event()
        self.naps = asyncio.Event()
        if not answers_steps:
            self.link.request = self._request  # type: ignore[method-assign]  # an arm that is on its way
        self.jog_client = JogClient(self.link, lambda: self.link.now_s, self.failures.append, self._nap)

    @property
    def asked(self) -> list[AnyRequest]:
        return self.link.asked

    async def until(self, met: Callable[[], bool]) -> None:
        for _ in range(1000):
            if met():
                return
            await asyncio.sleep(0)
        raise AssertionError("it does not come about")

    async def settle(self) -> None:
        for _ in range(20):
            await asyncio.sleep(0)

    async def pass_time(self, by_s: float) -> None:
        """Let time pass, and everybody who waits wake once."""
        self.link.now_s += by_s
        self.naps.set()
        self.naps = asyncio.Event()
        await self.settle()

    async def _nap(self, _: float) -> None:
        await self.naps.wait()

    async def _request(self, request: AnyRequest) -> None:
        self.link.asked.append(request)
        if isinstance(request, JogStep):
            await self.stands.wait()


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    made = Rig()
    yield made
    made.jog_client.let_go()
    await made.settle()


@pytest.fixture
async def moving_rig() -> AsyncIterator[Rig]:
    made = Rig(answers_steps=False)
    yield made
    made.jog_client.let_go()
    await made.settle()


HOLD = JogHold(joint="j1", direction=1)
STOP = JogHold(joint="j1", direction=0)


async def held(rig: Rig) -> None:
    rig.jog_client.press("j1", 1)
    await rig.settle()
    assert rig.asked == []
    rig.link.now_s += 0.5
    rig.jog_client.press("j1", 1)
    await rig.settle()
    assert rig.asked == [HOLD]


async def test_a_held_key_feeds_until_its_repeats_end(rig: Rig) -> None:
    await held(rig)
    for _ in range(4):
        await rig.pass_time(0.05)
        rig.jog_client.press("j1", 1)
    assert rig.asked == [HOLD] * 5
    for _ in range(7):
        await rig.pass_time(0.05)
    assert rig.asked[-1] == STOP
    assert rig.asked.count(STOP) == 1
    assert rig.asked[:-1] == [HOLD] * (len(rig.asked) - 1)
    assert len(rig.asked) <= 5 + 6 + 1
    assert not rig.jog_client.busy


async def test_letting_go_stops_at_once(rig: Rig) -> None:
    await held(rig)
    rig.jog_client.let_go()
    await rig.settle()
    assert rig.asked == [HOLD, STOP]
    rig.jog_client.press("j1", 1)
    await rig.settle()
    assert rig.asked == [HOLD, STOP]


async def test_the_other_way_stops_first(rig: Rig) -> None:
    await held(rig)
    rig.jog_client.press("j1", -1)
    await rig.pass_time(0.05)
    assert rig.asked[-1] == STOP
    rig.jog_client.press("j1", -1)
    await rig.settle()
    assert rig.asked[-1] == JogHold(joint="j1", direction=-1)


async def test_a_refusal_ends_the_hold_and_is_reported_once(rig: Rig) -> None:
    rig.link.refusals["jog-hold"] = "J1 comes too near to its limit: go on by steps"
    await held(rig)
    for _ in range(3):
        await rig.pass_time(0.01)
    assert rig.failures == ["J1 comes too near to its limit: go on by steps"]
    assert rig.asked == [HOLD, STOP]


async def test_a_step_is_kept_alive_and_excludes_others(moving_rig: Rig) -> None:
    rig = moving_rig
    assert rig.jog_client.step(Step("j2", -0.1, "P1"))
    await rig.settle()
    assert not rig.jog_client.step(Step("j1", 5.0))
    for _ in range(3):
        await rig.pass_time(0.05)
    assert rig.asked == [JogStep(joint="j2", by=-0.1, aim="P1"), *[Plain(op="ping")] * 3]
    rig.stands.set()
    await rig.until(lambda: not rig.jog_client.busy)
    await rig.pass_time(0.05)
    assert len(rig.asked) == 4
    assert rig.jog_client.step(Step("j1", 5.0))


async def test_steps_follow_one_another_and_end_at_a_refusal(rig: Rig) -> None:
    rig.jog_client.step(Step("j4", 80.0), Step("j4", 80.0))
    await rig.until(lambda: not rig.jog_client.busy)
    assert [step.by for step in rig.link.asked_for(JogStep)] == [80.0, 80.0]
    rig.asked.clear()
    rig.link.refusals["jog-step"] = "J4 would leave its range"
    rig.jog_client.step(Step("j4", 80.0), Step("j4", 80.0))
    await rig.until(lambda: not rig.jog_client.busy)
    assert rig.link.ops == ["jog-step"]
    assert rig.failures == ["J4 would leave its range"]


async def test_letting_go_stops_a_step(moving_rig: Rig) -> None:
    rig = moving_rig
    rig.jog_client.step(Step("j1", 10.0), Step("j1", 10.0))
    await rig.settle()
    rig.jog_client.let_go()
    await rig.settle()
    assert rig.link.ops == ["jog-step", "jog-hold"]
    assert [hold.direction for hold in rig.link.asked_for(JogHold)] == [0]


async def test_an_engine_that_answers_nothing_is_fed_no_longer(rig: Rig) -> None:
    silent = asyncio.Event()

    async def no_answer(request: AnyRequest) -> None:
        rig.asked.append(request)
        await silent.wait()
        raise RefusedError("late")

    rig.link.request = no_answer  # type: ignore[method-assign]  # an engine that hangs
    await held(rig)
    for _ in range(100):
        rig.jog_client.press("j1", 1)
        await rig.pass_time(0.02)
        if not rig.jog_client.busy:
            break
    assert not rig.jog_client.busy
    assert rig.asked[-1] == STOP
    assert "no longer answers" in rig.failures[0]
    silent.set()
