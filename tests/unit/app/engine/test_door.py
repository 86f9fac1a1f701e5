"""A door that opens during a run: STOP at once, and nothing moves before somebody has acknowledged it."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from catseye.app.engine.control import RunControl
from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.waiting import cancel
from catseye.app.exitcode import ExitCode
from catseye.drivers.roles.errors import LinkError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import ArmMovedError
from tests.unit.app.engine.fakes import AWAY, HOME, FakeRobot, Script
from tests.unit.app.engine.test_interlock import Block, GuardedBench

HALFWAY: Pose = (5.0, 10.0, 0.0, 15.0)


@dataclass
class HalfwayRobot(FakeRobot):
    """The first motion stands still halfway until it is stopped there."""

    targets: list[Pose] = field(default_factory=list)
    stopped_at: Pose = HALFWAY

    async def move_joints(self, target: Pose) -> None:
        self.targets.append(target)
        self.blocks = len(self.targets) == 1
        await super().move_joints(target)

    async def stop(self) -> None:
        if self.state.running:
            self.pose = self.stopped_at
        await super().stop()


@pytest.fixture
def bench(tmp_path: Path) -> GuardedBench:
    made = GuardedBench(tmp_path)
    made.block = Block()
    made.robot = HalfwayRobot(made.clock)
    return made


async def moving(ctx: Context) -> None:
    await ctx.move(AWAY)
    await ctx.move(HOME)


async def opened(
    bench: GuardedBench,
    body: Callable[[Context], Awaitable[None]] = moving,
    answerer: Callable[[Prompt], Awaitable[Answer | None]] | None = None,
    *,
    close: bool = True,
    real: bool = False,
) -> RunOutcome:
    """Run; the door opens while the arm moves, and is closed when it stands unless it stays open."""
    if real:
        bench.make_real()
        bench.block.simulated = False
    request = bench.request(Script(body), answerer=answerer, arm="lab-1" if real else None)
    running = asyncio.create_task(
        run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    )
    moves = asyncio.create_task(bench.robot.moving.wait())
    await asyncio.wait({running, moves}, return_when=asyncio.FIRST_COMPLETED)
    await cancel(moves)
    bench.block.closed = False
    while "UNSUSPENDING" not in bench.states() and not running.done():  # noqa: ASYNC110  # the bench only keeps a list
        await asyncio.sleep(0)
    bench.block.closed = close
    return await running


async def test_an_open_door_stops_the_motion_at_once(bench: GuardedBench) -> None:
    outcome = await opened(bench)
    assert outcome.status == "complete"
    calls = bench.robot.calls[bench.robot.calls.index("move") :]
    assert calls == ["move", "stop", "move cancelled", "move", "move", "servo off", "close"]
    assert bench.states() == ["STARTING", "EXECUTE", "SUSPENDING", "UNSUSPENDING", "EXECUTE", "COMPLETE"]


async def test_the_rest_of_the_way_is_driven_after_the_acknowledgement(bench: GuardedBench) -> None:
    order: list[str] = []

    async def ada(prompt: Prompt) -> Answer:
        order.append(f"{prompt.id} {bench.robot.calls.count('move')}")
        assert prompt.motion
        return Answer("yes", "Ada")

    outcome = await opened(bench, answerer=ada, real=True)
    assert outcome.status == "complete"
    assert order == ["acknowledge/1 1"]
    assert isinstance(bench.robot, HalfwayRobot)
    assert bench.robot.targets == [AWAY, AWAY, HOME]


async def test_where_nobody_acknowledges_the_run_ends_stopped(bench: GuardedBench) -> None:
    outcome = await opened(bench, real=True)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.SAFETY)
    assert "the door is open" in outcome.text
    assert "catseye resume" in outcome.text
    assert bench.robot.calls.count("move") == 1


async def test_an_answer_of_no_ends_the_run_resumable(bench: GuardedBench) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        return Answer("no", "Ada")

    outcome = await opened(bench, answerer=ada)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.SAFETY)
    assert bench.robot.calls.count("move") == 1


async def test_a_yes_before_an_open_door_is_asked_again(bench: GuardedBench) -> None:
    asked: list[str] = []

    async def ada(prompt: Prompt) -> Answer:
        asked.append(prompt.id)
        assert bench.robot.calls.count("move") == 1
        return Answer("yes", "Ada")

    running = asyncio.create_task(opened(bench, answerer=ada, close=False))
    while not bench.said("warning")[1:] and not running.done():  # noqa: ASYNC110  # the bench only keeps a list
        await asyncio.sleep(0)
    bench.block.closed = True
    outcome = await running
    assert outcome.status == "complete"
    assert asked == ["acknowledge/1", "acknowledge/2"]
    assert any("not yet: the door is open" in str(said["text"]) for said in bench.said("warning"))


async def test_an_arm_moved_beside_its_way_is_not_driven_on(bench: GuardedBench) -> None:
    assert isinstance(bench.robot, HalfwayRobot)
    bench.robot.stopped_at = (5.0, 14.0, 0.0, 15.0)
    found: list[str] = []

    async def body(ctx: Context) -> None:
        with pytest.raises(ArmMovedError) as raised:
            await ctx.move(AWAY)
        found.append(str(raised.value))

    await opened(bench, body)
    assert "beside the way" in found[0]
    assert bench.robot.calls.count("move") == 1


async def test_a_count_is_worth_nothing_after_the_door(bench: GuardedBench) -> None:
    found: list[bool] = []

    async def body(ctx: Context) -> None:
        await ctx.zero(0.0)
        found.append((await ctx.measure(0.0, 0.0, 1)).beam.count_valid)
        await ctx.move(AWAY)
        found.append((await ctx.measure(0.0, 0.0, 1)).beam.count_valid)
        await ctx.zero(0.0)
        found.append((await ctx.measure(0.0, 0.0, 1)).beam.count_valid)

    await opened(bench, body)
    assert found == [True, False, True]


async def test_a_door_that_opens_while_nothing_moves_is_acknowledged(bench: GuardedBench) -> None:
    async def body(ctx: Context) -> None:
        bench.robot.moving.set()
        while "UNSUSPENDING" not in bench.states():  # noqa: ASYNC110  # the bench only keeps a list
            await asyncio.sleep(0)
        bench.robot.moving.clear()
        await ctx.event("measured", ok=True)
        assert isinstance(bench.robot, HalfwayRobot)
        bench.robot.targets.append(HOME)
        await ctx.move(AWAY)

    outcome = await opened(bench, body)
    assert outcome.status == "complete"
    assert [said["id"] for said in bench.said("prompt")] == ["acknowledge/1"]
    assert bench.robot.calls.count("move") == 1


async def door_seen(bench: GuardedBench, *, closed: bool) -> None:
    """Open or close the door and let the watch see it."""
    bench.block.closed = closed
    for _ in range(50):
        await asyncio.sleep(0)


async def test_an_answer_to_an_older_question_acknowledges_nothing(bench: GuardedBench) -> None:
    """The answer was on its way when somebody opened the door, and closed it behind them."""
    moved: list[tuple[str, int]] = []

    async def ada(prompt: Prompt) -> Answer:
        moved.append((prompt.id, bench.robot.calls.count("move")))
        if prompt.id == "place/P1":
            bench.robot.moving.set()
            while "UNSUSPENDING" not in bench.states():  # noqa: ASYNC110  # the bench reports by a list
                await asyncio.sleep(0)
            await door_seen(bench, closed=True)
        return Answer("yes", "Ada")

    async def body(ctx: Context) -> None:
        await ctx.ask(Prompt("place/P1", "confirm", "Put it there.", motion=True))
        assert isinstance(bench.robot, HalfwayRobot)
        bench.robot.targets.append(HOME)
        await ctx.move(AWAY)

    outcome = await opened(bench, body, ada)
    assert outcome.status == "complete"
    assert moved == [("place/P1", 0), ("acknowledge/1", 0)]


async def test_a_door_opened_anew_is_asked_about_anew(bench: GuardedBench) -> None:
    asked: list[tuple[str, int]] = []

    async def ada(prompt: Prompt) -> Answer:
        asked.append((prompt.id, bench.robot.calls.count("move")))
        if len(asked) == 1:
            for closed in (True, False, True):
                await door_seen(bench, closed=closed)
        return Answer("yes", "Ada")

    outcome = await opened(bench, answerer=ada)
    assert outcome.status == "complete"
    assert asked == [("acknowledge/1", 1), ("acknowledge/2", 1)]


async def test_each_reason_is_named_before_it_is_acknowledged(bench: GuardedBench) -> None:
    asked: list[str] = []

    async def body(ctx: Context) -> None:
        controls.append(ctx._control)  # type: ignore[attr-defined]  # noqa: SLF001  # the run's own ladder
        await ctx.move(AWAY)

    async def ada(prompt: Prompt) -> Answer:
        asked.append(prompt.text)
        if len(asked) == 1:
            await door_seen(bench, closed=True)
            controls[0].interrupt("the guard stopped the arm")
        return Answer("yes", "Ada")

    controls: list[RunControl] = []
    outcome = await opened(bench, body, ada)
    assert outcome.status == "complete"
    assert ["the guard stopped the arm" in text for text in asked] == [False, True]


async def test_a_safe_answer_of_nobody_acknowledges_nothing(bench: GuardedBench) -> None:
    """The time of a question runs out while the door stands open, or was just closed again."""

    async def nobody(prompt: Prompt) -> Answer | None:
        if prompt.id.startswith("acknowledge"):
            return None
        bench.robot.moving.set()
        while "UNSUSPENDING" not in bench.states() or not bench.block.closed:  # noqa: ASYNC110  # as above
            await asyncio.sleep(0)
        for _ in range(50):
            await asyncio.sleep(0)
        raise TimeoutError

    async def body(ctx: Context) -> None:
        question = Prompt(
            "settled/1",
            "choice",
            "?",
            ("again", "skip"),
            timeout_s=60.0,
            safe_answer="skip",
            motion=True,
            rests_after=(),
        )
        await ctx.ask(question)
        assert isinstance(bench.robot, HalfwayRobot)
        bench.robot.targets.append(HOME)
        await ctx.move(AWAY)

    outcome = await opened(bench, body, nobody, real=True)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.SAFETY)
    assert "move" not in bench.robot.calls


async def test_a_hold_outlasts_the_acknowledgement(bench: GuardedBench) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        controls[0].hold("Ada holds")
        return Answer("yes", "Ada")

    controls: list[RunControl] = []

    async def body(ctx: Context) -> None:
        controls.append(ctx._control)  # type: ignore[attr-defined]  # noqa: SLF001  # the run's own ladder
        await ctx.move(AWAY)

    running = asyncio.create_task(opened(bench, body, ada))
    while "HELD" not in bench.states() and not running.done():  # noqa: ASYNC110  # the bench only keeps a list
        await asyncio.sleep(0)
    assert bench.robot.calls.count("move") == 1
    controls[0].unhold("Ada goes on")
    assert (await running).status == "complete"
    assert bench.robot.calls.count("move") == 2


async def test_a_standstill_that_is_not_seen_aborts(bench: GuardedBench) -> None:
    bench.robot.ignores_stop = True
    outcome = await opened(bench)
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert "standstill was not confirmed" in outcome.text
    assert bench.robot.calls.count("move") == 1
    assert outcome.drives_on is False


async def test_drives_a_halt_cannot_switch_off_are_reported_on(
    bench: GuardedBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.robot.ignores_stop = True
    servo = bench.robot.servo

    async def only_on(*, on: bool) -> None:
        if not on:
            raise LinkError("robot: no answer")
        await servo(on=on)

    monkeypatch.setattr(bench.robot, "servo", only_on)
    outcome = await opened(bench)
    assert (outcome.status, outcome.drives_on) == ("aborted", True)
    assert bench.said("run-ended")[0]["drives_on"] is True


async def test_an_alarm_during_the_interruption_aborts(bench: GuardedBench) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        bench.robot.state = replace(bench.robot.state, emergency_stop=True)
        return Answer("yes", "Ada")

    outcome = await opened(bench, answerer=ada)
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert bench.robot.calls.count("move") == 1


async def test_a_watch_that_is_cancelled_from_outside_ends_the_run(
    bench: GuardedBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def body(ctx: Context) -> None:
        async def cancelled() -> bool:
            raise asyncio.CancelledError

        monkeypatch.setattr(bench.block, "door_closed", cancelled)
        bench.robot.blocks = True
        await ctx.move(AWAY)

    request = bench.request(Script(body))
    outcome = await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    assert outcome.status == "failed"
    assert "a watch has ended before its run" in outcome.text
    assert "stop" in bench.robot.calls
