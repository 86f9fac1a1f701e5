"""Whatever is asked by hand in whatever order: nothing moves after a stop, beyond a limit, or unfed."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Any, Literal

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from catseye.app.protocol.requests import JogHold, JogMode, JogStep
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.jogging import Jogging
from tests.unit.app.service.manual.benches import cell_from_template, client
from tests.unit.app.service.manual.timed_arm import ManualFixture, TimedArm
from tests.unit.drivers.virtual_time import runner

PERCENT = 5.0
CELL = cell_from_template()
LIMITS = CELL.robot.limits_deg
JOINTS: st.SearchStrategy[Literal["j1", "j2", "j4"]] = st.sampled_from(["j1", "j2", "j4"])
WAYS: st.SearchStrategy[Literal[-1, 1]] = st.sampled_from([-1, 1])


class JogMachine(RuleBasedStateMachine):
    """A client, a bench and an arm; the time is that of the loop."""

    def __init__(self) -> None:
        super().__init__()
        self.runner = runner()
        # Near enough to its limits that steps and holds reach them.
        self.fixture = ManualFixture(CELL, TimedArm(speed_deg_s=15.0, pose=(150.0, -120.0, 50.0, 340.0)))
        self.arm = self.fixture.arm
        self.jog: Jogging | None = None
        self.heard_s = self.fed_s = -10.0
        self.steps: list[asyncio.Future[Any]] = []
        self.quiet_after: int | None = None

    def do(self, work: Callable[[], Awaitable[None]], seconds: float = 0.0) -> None:
        """Do something within the loop, then let time pass."""

        async def both() -> None:
            await work()
            await asyncio.sleep(seconds)

        self.runner.run(both())

    @property
    def under_way(self) -> bool:
        """A jog has begun and nobody has ended it."""
        return self.jog is not None and self.quiet_after is None

    @precondition(lambda self: self.jog is None)
    @rule(wait_s=st.sampled_from([0.0, 0.02, 0.3]))
    def begin(self, wait_s: float) -> None:
        """Somebody begins to jog, and may not wait until it has begun."""

        async def work() -> None:
            request = JogMode.model_validate({"on": True, "percent": PERCENT})
            self.jog = Jogging(self.fixture.bench, request, client())
            self.jog.begun.add_done_callback(lambda begun: begun.exception())
            self.quiet_after = None

        self.do(work, wait_s)

    @precondition(lambda self: self.jog is not None)
    @rule(
        joint=JOINTS,
        by=st.sampled_from([-40.0, -25.0, -3.0, 3.0, 25.0, 40.0]),
        wait_s=st.sampled_from([0.0, 0.05, 0.4]),
    )
    def step(self, joint: Literal["j1", "j2", "j4"], by: float, wait_s: float) -> None:
        """Ask for a step; whether there are signs of life later on is a matter of other rules."""

        async def work() -> None:
            self.heard_s = asyncio.get_running_loop().time()
            request = JogStep(joint=joint, by=by)
            assert self.jog is not None
            try:
                step = self.jog.step(request, lambda: self.heard_s)
            except RefusedError:
                return
            step.add_done_callback(lambda done: done.exception())
            self.steps.append(step)

        self.do(work, wait_s)

    @precondition(lambda self: self.jog is not None)
    @rule(joint=JOINTS, way=WAYS, times=st.integers(1, 12))
    def feed(self, joint: Literal["j1", "j2", "j4"], way: Literal[-1, 1], times: int) -> None:
        """Hold a key for a while."""

        async def work() -> None:
            for _ in range(times):
                self.heard_s = self.fed_s = asyncio.get_running_loop().time()
                assert self.jog is not None
                try:
                    answer = self.jog.hold(JogHold(joint=joint, direction=way))
                except RefusedError:
                    return
                if isinstance(answer, asyncio.Future):
                    answer.add_done_callback(lambda done: done.exception())
                await asyncio.sleep(0.1)
                self.look()

        self.do(work)

    @precondition(lambda self: self.jog is not None)
    @rule()
    def release(self) -> None:
        """Let the key go."""

        async def work() -> None:
            self.heard_s = asyncio.get_running_loop().time()
            assert self.jog is not None
            try:
                self.jog.hold(JogHold(joint="j1", direction=0))
            except RefusedError:
                return

        self.do(work)

    @rule(duration_s=st.sampled_from([0.1, 0.3, 1.0, 3.0]))
    def time_passes(self, duration_s: float) -> None:
        """Nobody asks for anything, and the client is silent."""

        async def work() -> None:
            for _ in range(round(duration_s / 0.01)):
                await asyncio.sleep(0.01)
                self.look()

        self.do(work)

    @rule(duration_s=st.sampled_from([0.3, 2.0]))
    def client_lives(self, duration_s: float) -> None:
        """The client gives signs of life and asks for nothing."""

        async def work() -> None:
            for _ in range(round(duration_s / 0.1)):
                self.heard_s = asyncio.get_running_loop().time()
                await asyncio.sleep(0.1)
                self.look()

        self.do(work)

    @precondition(lambda self: self.jog is not None)
    @rule(wait_s=st.sampled_from([0.0, 0.05, 2.0]))
    def end(self, wait_s: float) -> None:
        """Somebody stops it."""

        async def work() -> None:
            assert self.jog is not None
            self.jog.end("Ben stopped it")
            if self.quiet_after is None:
                self.quiet_after = len(self.arm.log)

        self.do(work, wait_s)

    @precondition(lambda self: self.jog is not None and self.quiet_after is not None)
    @rule()
    def over(self) -> None:
        """The engine lets others use the bench when the jog is over."""

        async def work() -> None:
            assert self.jog is not None
            await self.jog.over()
            self.jog = None

        self.do(work)
        self.at_rest()

    @rule(closed=st.sampled_from([True, True, False]))
    def door(self, closed: bool) -> None:
        """Somebody opens or closes the door."""
        self.fixture.door.closed = closed

    @rule()
    def override_raised(self) -> None:
        """Somebody raises the override at the controller."""
        self.arm.state = replace(self.arm.state, override_percent=100.0)

    @rule(number=st.sampled_from([0, 0, 2100]))
    def alarm(self, number: int) -> None:
        """An alarm comes up, or is reset."""
        self.arm.state = replace(
            self.arm.state, alarm_number=number, alarm_text="collision" if number else ""
        )

    @rule(answer_s=st.sampled_from([0.002, 0.02, 0.08]), speed_deg_s=st.sampled_from([2.0, 15.0, 21.0]))
    def another_pace(self, answer_s: float, speed_deg_s: float) -> None:
        """The controller answers faster or slower from now on; its next motion is faster or slower."""
        self.arm.answer_s, self.arm.speed_deg_s = answer_s, speed_deg_s

    def look(self) -> None:
        """Check the arm at this moment."""
        self.arm.settle()
        j1, j2, _, j4 = self.arm.pose
        for angle, (low, high) in zip((j1, j2, j4), (LIMITS.j1, LIMITS.j2, LIMITS.j4), strict=True):
            assert low <= angle <= high
        now_s = asyncio.get_running_loop().time()
        if self.arm.feed is not None and now_s - self.fed_s > 0.4:
            assert not self.arm.moving
            # Not by the arm's own dead-man alone.
            assert self.arm.said("jog", "stop")[-1] == "stop"
        if self.arm.feed is None and now_s - self.heard_s > 0.7:
            assert not self.arm.moving

    @invariant()
    def nothing_begins_after_a_stop(self) -> None:
        """Behind the end of a jog stands no motion command until the next one begins."""
        if self.quiet_after is not None:
            later = [text.split()[0] for _, text in self.arm.log[self.quiet_after :]]
            assert not {"move", "jog", "override"} & set(later)
            assert "servo on" not in later

    @invariant()
    def the_override_was_down_whenever_something_began(self) -> None:
        """It is lowered, and read back, before each motion."""
        assert all(percent <= PERCENT for percent in self.arm.began_at_percent)

    def at_rest(self) -> None:
        """Check what every jog leaves behind."""

        async def work() -> None:
            assert not self.arm.moving
            assert not self.arm.state.servo_on
            assert not self.fixture.acquired_now

        self.do(work)

    def teardown(self) -> None:
        """An end stops the arm, whatever came before, and leaves nothing behind."""

        async def work() -> None:
            if self.jog is not None:
                self.jog.end("the end")
                await self.jog.over()
            await asyncio.sleep(1.0)
            assert asyncio.all_tasks() == {asyncio.current_task()}

        self.do(work)
        self.at_rest()
        assert all(step.done() for step in self.steps)
        self.runner.close()


TestJogMachine = JogMachine.TestCase
TestJogMachine.settings = settings(max_examples=80, stateful_step_count=25)
