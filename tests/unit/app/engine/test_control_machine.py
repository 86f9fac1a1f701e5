"""Whatever is asked in whatever order: nothing begins to move without permission, and nothing after a stop."""

import asyncio
from collections.abc import Coroutine
from dataclasses import replace
from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from catseye.app.engine.control import RunControl
from catseye.app.engine.halt import HaltLimits
from catseye.app.errors import CatseyeError, SafetyError
from catseye.app.protocol.state import ENDED, ControlState
from catseye.drivers.roles.pose import Pose
from tests.unit.app.engine.fakes import AWAY, FakeRobot, ManualClock

MAY_BEGIN = {ControlState.EXECUTE}
MAY_GO_ON = MAY_BEGIN | {ControlState.HOLDING, ControlState.SUSPENDED}
"""A move that is under way when a hold or a suspension comes ends by itself."""


class WatchedRobot(FakeRobot):
    """Records in which state of the run each of its motions began."""

    def watch(self, control: RunControl) -> None:
        """Look at this run."""
        self.control = control
        self.began: list[ControlState] = []

    async def move_joints(self, target: Pose) -> None:
        """Note the state, then move."""
        self.began.append(self.control.state)
        await super().move_joints(target)


class EngineMachine(RuleBasedStateMachine):
    """A run whose procedure moves whenever it may, on a loop that is stepped by hand."""

    def __init__(self) -> None:
        super().__init__()
        self.loop = asyncio.new_event_loop()
        self.clock = ManualClock()
        self.robot = WatchedRobot(self.clock)
        self.robot.state = replace(self.robot.state, servo_on=True)
        self.back = True
        self.stops_asked = self.began_at_stop = 0
        self.acknowledged_at: list[int] = []
        self.interrupted_at: list[int] = []
        self.tasks: list[asyncio.Task[Any]] = []
        self.control = RunControl(self.clock, lambda _state, _reason: None, HaltLimits(standstill_s=0.5))
        self.robot.watch(self.control)
        self.control.attach(self.robot)
        self.control.starting()
        self.control.started()

    def step(self, count: int = 15) -> None:
        """Let every task go on for some turns."""

        async def turns() -> None:
            for _ in range(count):
                await asyncio.sleep(0)

        self.loop.run_until_complete(turns())

    def ask(self, request: Coroutine[Any, Any, None]) -> None:
        """Begin something, as a procedure or a front end would, inside the loop."""
        self.tasks.append(self.loop.create_task(self._quiet(request)))
        self.step(1)

    async def _quiet(self, request: Coroutine[Any, Any, None]) -> None:
        try:
            await request
        except CatseyeError:
            return

    async def _call(self, name: str, *arguments: object) -> None:
        getattr(self.control, name)(*arguments)

    @precondition(lambda self: all(task.done() for task in self.tasks))
    @rule(blocks=st.booleans())
    def the_procedure_moves(self, blocks: bool) -> None:
        """The procedure asks for a move; some never end by themselves."""
        self.robot.blocks = blocks

        async def gate() -> None:
            # Long enough for something to happen while the gate looks.
            for _ in range(6):
                await asyncio.sleep(0)

        self.ask(self.control.motion(gate, lambda: self.robot.move_joints(AWAY)))

    @precondition(lambda self: all(task.done() for task in self.tasks))
    @rule()
    def the_procedure_waits_for_a_condition(self) -> None:
        """The procedure finds the door open."""

        async def look() -> bool:
            await asyncio.sleep(0)
            return self.back

        self.ask(self.control.suspended("the door is open", look, 0.5))

    @rule(there=st.booleans())
    def the_condition_changes(self, there: bool) -> None:
        """Somebody opens or closes the door."""
        self.back = there

    @rule(name=st.sampled_from(["hold", "unhold", "suspend", "condition_back"]))
    def somebody_asks(self, name: str) -> None:
        """A front end or the watchman asks for something."""
        self.ask(self._call(name, "test"))

    @rule()
    def the_door_opens(self) -> None:
        """The surroundings stop the robot."""
        self.ask(self._open_door())

    async def _open_door(self) -> None:
        before = self.control.interruptions
        self.control.interrupt("the door is open")
        if self.control.interruptions > before:
            self.interrupted_at.append(len(self.robot.began))

    @rule()
    def somebody_acknowledges(self) -> None:
        """A person allows the arm to move again."""
        self.ask(self._acknowledge())

    async def _acknowledge(self) -> None:
        # Asked in the very turn: a halt that ends in the turns before makes the acknowledgement count.
        if self.control.state == ControlState.UNSUSPENDING:
            self.acknowledged_at.append(len(self.robot.began))
        self.control.acknowledge("test")

    def note_stop(self) -> None:
        """Remember how many motions had begun when the first stop was asked for."""
        if not self.stops_asked:
            self.began_at_stop = len(self.robot.began)
        self.stops_asked += 1

    @rule()
    def somebody_stops(self) -> None:
        """A front end stops the run."""
        self.note_stop()
        self.ask(self._call("stop", "test"))

    @rule()
    def somebody_aborts(self) -> None:
        """Something makes motion unsafe."""
        self.note_stop()
        self.ask(self._call("abort", SafetyError("alarm")))

    @rule(count=st.integers(1, 40))
    def time_passes(self, count: int) -> None:
        """Tasks go on."""
        self.step(count)

    @invariant()
    def motions_begin_in_execute_only(self) -> None:
        """No other state lets a motion begin."""
        assert set(self.robot.began) <= MAY_BEGIN

    @invariant()
    def nothing_begins_after_a_stop(self) -> None:
        """Behind the first stop on the wire stands no motion command."""
        calls = self.robot.calls
        if self.stops_asked and "stop" in calls:
            last = len(calls) - 1 - calls[::-1].index("stop")
            assert "move" not in calls[last:]
            assert len(self.robot.began) == self.began_at_stop

    @invariant()
    def nothing_begins_between_a_door_and_its_acknowledgement(self) -> None:
        """As many motions have begun at the acknowledgement as at the interruption."""
        done = len(self.acknowledged_at)
        assert self.interrupted_at[:done] == self.acknowledged_at
        for begun in self.interrupted_at[done:]:
            assert len(self.robot.began) == begun

    @invariant()
    def a_move_goes_on_only_where_it_may(self) -> None:
        """While the arm moves the run executes, holds or is suspended, or a stop is on its way."""
        if self.robot.state.running and not self.stops_asked:
            assert self.control.state in MAY_GO_ON | {ControlState.SUSPENDING}

    def teardown(self) -> None:
        """A stop ends every run, whatever came before, and it reaches the robot."""
        self.ask(self._call("stop", "the end"))
        self.step(400)
        assert self.control.state in ENDED
        assert "stop" in self.robot.calls
        assert not self.robot.state.running
        assert all(task.done() for task in self.tasks)
        self.loop.close()


TestEngineMachine = EngineMachine.TestCase
TestEngineMachine.settings = settings(max_examples=60, stateful_step_count=25)
