"""The door before the first motion; the stack light follows the run and never holds it up."""

import asyncio
from pathlib import Path

import pytest

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.host import run_procedure
from catseye.app.engine.interlock import StackLight
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import PromptAnswered, PromptAsked, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkTimeoutError
from catseye.drivers.roles.io import Io, Light
from catseye.procedures.kit.context import Context
from tests.unit.app.engine.fakes import AWAY, FakeBench, Script, identity


class Block(Io):
    """A scripted block of inputs and outputs."""

    def __init__(self) -> None:
        self.closed = True
        self.simulated = True
        self.silent = False
        self.hangs = False
        self.shown: list[Light] = []

    async def connect(self) -> Identity:
        return identity(simulated=self.simulated)

    async def close(self) -> None:
        """Nothing is open."""

    async def door_closed(self) -> bool:
        if self.silent:
            raise LinkTimeoutError("no answer")
        return self.closed

    async def show(self, light: Light) -> None:
        if self.hangs and light != "off":
            await asyncio.Event().wait()
        if self.silent:
            raise LinkTimeoutError("no answer")
        if not self.shown or self.shown[-1] != light:
            self.shown.append(light)


class GuardedBench(FakeBench):
    """A bench with a block."""

    block: Block

    def build(self, record: WireRecorder) -> Devices:
        devices = super().build(record)
        return Devices(devices.robot, devices.interferometer, devices.environment, io=self.block)


@pytest.fixture
def bench(tmp_path: Path) -> GuardedBench:
    made = GuardedBench(tmp_path)
    made.block = Block()
    return made


async def test_an_open_door_at_the_start_refuses_the_run(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        await ctx.move(AWAY)

    bench.block.closed = False
    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert "door is open" in outcome.text
    assert "move" not in bench.robot.calls
    assert bench.block.shown[-2:] == ["red", "off"]


async def test_the_light_follows_the_run(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        for _ in range(5):
            await ctx.move(AWAY)

    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert outcome.status == "complete"
    assert bench.block.shown == ["green", "off"]


async def test_a_hanging_block_does_not_delay_the_run(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        await ctx.move(AWAY)

    bench.block.hangs = True
    outcome = await run_procedure(
        bench.request(Script(body)), bench.build, bench.clock, bench.publish, bench.install
    )
    assert outcome.status == "complete"
    assert bench.block.shown == ["off"]


async def test_states_and_questions_have_their_colours() -> None:
    block, reported = Block(), list[str]()
    light = StackLight(block, reported.append)

    async def after(event: RunEvent) -> Light:
        light.take(event)
        for _ in range(3):
            await asyncio.sleep(0)
        return block.shown[-1]

    async def in_state(state: ControlState) -> Light:
        return await after(StateChanged(state=state))

    asked = PromptAsked(id="door", kind="confirm", text="Close the door.")
    assert await in_state(ControlState.EXECUTE) == "green"
    assert await after(asked) == "amber"
    assert await after(PromptAnswered(id="door", answer="yes", who="Ada")) == "green"
    assert await in_state(ControlState.HELD) == "amber"
    assert await in_state(ControlState.ABORTING) == "red"
    assert await after(asked) == "red"
    block.silent = True
    for _ in range(2):
        await in_state(ControlState.EXECUTE)
    assert len(reported) == 1
    block.silent = False
    await light.end()
    assert block.shown[-1] == "off"
