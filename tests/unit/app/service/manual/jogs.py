"""A jog in virtual time, from its beginning to its end, with what a script does between."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.protocol.requests import JogHold, JogMode, JogStep
from catseye.app.service.manual.jogging import Jogging
from tests.unit.app.service.manual.benches import client
from tests.unit.app.service.manual.timed_arm import ManualFixture, TimedArm
from tests.unit.drivers.virtual_time import run

Script = Callable[[ManualFixture, Jogging], Awaitable[None]]


def mode(**fields: Any) -> JogMode:
    return JogMode.model_validate({"on": True, **fields})


def step(**fields: Any) -> JogStep:
    return JogStep.model_validate({**fields})


def hold(joint: str = "j1", direction: int = 1) -> JogHold:
    return JogHold.model_validate({"joint": joint, "direction": direction})


def now_s() -> float:
    return asyncio.get_running_loop().time()


def jogged(cell: Cell, script: Script, robot: TimedArm | None = None, **fields: Any) -> ManualFixture:
    """Begin a jog, do what the script says, end it if the script has not; return what is left."""

    async def work() -> ManualFixture:
        fixture = ManualFixture(cell, robot or TimedArm())
        jog = Jogging(fixture.bench, mode(**fields), client())
        await jog.begun
        await script(fixture, jog)
        jog.end("the script is over")
        await jog.over()
        assert not fixture.acquired_now
        return fixture

    return run(work())


async def fed(jog: Jogging, duration_s: float, request: JogHold) -> None:
    """Feed every 0.1 s for a time."""
    end_s = now_s() + duration_s
    while now_s() < end_s:
        answer = jog.hold(request)
        if isinstance(answer, asyncio.Future):
            await answer
        await asyncio.sleep(0.1)


async def alive(jog: Jogging, request: JogStep) -> Any:
    """Step as a client does that gives signs of life all the time."""
    return await jog.step(request, now_s)


async def nothing(_fixture: ManualFixture, _jog: Jogging) -> None:
    """End it as soon as it has begun."""
