"""A run that nobody could let go on ends by itself, whatever it waits for."""

import asyncio
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from catseye.app.engine.control import RunControl
from catseye.app.engine.hold_limit import HoldLimit
from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.engine.waiting import cancel
from catseye.app.errors import CatseyeError, HeldTooLongError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import PromptAsked, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.records import Json
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import FakeBench, ManualClock, Script
from tests.unit.app.engine.runs import measuring

LIMIT_S = 900.0
LOOK_S = 5.0
"""Between two looks; longer than what the clock lets pass by itself."""


@dataclass
class Watched:
    """A run under a limit, and whether somebody is there."""

    clock: ManualClock = field(default_factory=ManualClock)
    attended: bool = False
    waiting: list["asyncio.Task[None]"] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.control = RunControl(self.clock, lambda _state, _reason: None)
        self.control.starting()
        self.control.started()

    def ending(self) -> CatseyeError | None:
        return self.control.ending

    async def pass_s(self, duration_s: float) -> None:
        for _ in range(round(duration_s / LOOK_S)):
            self.clock.advance(LOOK_S)
            # Whoever slept looks, and sleeps again.
            for _ in range(3):
                await asyncio.sleep(0)


@pytest.fixture
async def watched() -> AsyncIterator[Watched]:
    found = Watched()
    limit = HoldLimit(found.control, found.clock, lambda: found.attended, LIMIT_S, 1.0, LOOK_S)
    task = asyncio.create_task(limit.watch())
    await asyncio.sleep(0)
    yield found
    await found.control.halted()
    await cancel(task, *found.waiting)


async def hold(watched: Watched) -> None:
    """Hold it at a checkpoint, where the procedure waits until the run ends."""
    watched.control.hold("Ada holds the run")
    watched.waiting.append(asyncio.create_task(watched.control.checkpoint()))
    await asyncio.sleep(0)


async def suspend(watched: Watched) -> None:
    """Miss a condition of the surroundings."""
    watched.control.suspend("the air is too warm")


async def interrupt(watched: Watched) -> None:
    """Open the door."""
    watched.control.interrupt("the door is open")
    await watched.control.halted()


@pytest.mark.parametrize("wait", [hold, suspend, interrupt], ids=lambda wait: wait.__name__)
async def test_every_wait_ends_when_nobody_is_there(
    watched: Watched, wait: Callable[[Watched], Awaitable[None]]
) -> None:
    await wait(watched)
    await watched.pass_s(LIMIT_S - 2 * LOOK_S)
    assert watched.ending() is None
    await watched.pass_s(3 * LOOK_S)
    assert isinstance(ending := watched.ending(), HeldTooLongError)
    assert "for 900 s ([engine] hold_limit_s)" in str(ending)


async def test_a_question_ends_when_nobody_is_there(watched: Watched) -> None:
    with watched.control.wait_time.asking("beam/P1"):
        await watched.pass_s(LIMIT_S + LOOK_S)
    assert str(watched.ending()).startswith("the question 'beam/P1' was open")


async def test_a_wait_with_somebody_there_does_not_end(watched: Watched) -> None:
    watched.attended = True
    await suspend(watched)
    await watched.pass_s(10 * LIMIT_S)
    assert watched.ending() is None


async def test_the_limit_counts_from_the_last_who_left(watched: Watched) -> None:
    watched.attended = True
    await suspend(watched)
    await watched.pass_s(2 * LIMIT_S)
    watched.attended = False
    await watched.pass_s(LIMIT_S - 2 * LOOK_S)
    assert watched.ending() is None
    await watched.pass_s(3 * LOOK_S)
    assert watched.ending() is not None


async def test_every_wait_has_the_whole_limit(watched: Watched) -> None:
    for _ in range(3):
        await suspend(watched)
        await watched.pass_s(LIMIT_S - 2 * LOOK_S)
        watched.control.condition_back("over")
        await watched.pass_s(LOOK_S)
    assert watched.ending() is None


async def test_a_run_that_goes_on_does_not_end(watched: Watched) -> None:
    await watched.pass_s(3 * LIMIT_S)
    assert watched.ending() is None


async def test_a_run_held_by_nobody_is_resumable(tmp_path: Path) -> None:
    bench = FakeBench(tmp_path)

    def publish(event: RunEvent) -> None:
        if isinstance(event, StateChanged) and event.state is ControlState.EXECUTE:
            asyncio.get_running_loop().call_soon(bench.signal, signal.SIGINT)

    request = bench.request(measuring(0, 1), hold_limit_s=LIMIT_S)
    outcome = await run_procedure(request, bench.build, bench.clock, publish, bench.install)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.TIMEOUT)
    assert RunReader(outcome.path).status == "stopped"


async def asks(ctx: Context) -> None:
    """Ask what nobody answers."""
    await ctx.ask(Prompt(id="sure", kind="confirm", text="Sure?"))


async def waits(_prompt: Prompt) -> Answer | None:
    """Wait for an answer that never comes."""
    await asyncio.get_running_loop().create_future()
    return None


async def test_a_stop_while_a_question_is_stored_ends_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench, stored = FakeBench(tmp_path), RunStore.event

    async def event(store: RunStore, kind: str, data: Mapping[str, Json] | None = None) -> None:
        await stored(store, kind, data)
        if kind == "asked":
            bench.signal(signal.SIGTERM)
            # The halt is over before anybody waits for the answer.
            for _ in range(50):
                await asyncio.sleep(0)

    monkeypatch.setattr(RunStore, "event", event)
    request = bench.request(Script(asks), answerer=waits)
    async with asyncio.timeout(HANG_S):
        outcome = await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    assert outcome.exit_code == ExitCode.TERMINATED


async def test_a_question_that_nobody_answers_ends_the_run(tmp_path: Path) -> None:
    bench = FakeBench(tmp_path)
    asked: list[RunEvent] = []
    request = bench.request(Script(asks), hold_limit_s=LIMIT_S, answerer=waits)
    outcome = await run_procedure(request, bench.build, bench.clock, asked.append, bench.install)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.TIMEOUT)
    assert [event.id for event in asked if isinstance(event, PromptAsked)] == ["sure"]
    assert RunReader(outcome.path).status == "stopped"
