"""The stop ladder with a scripted robot."""

import asyncio
import signal
from collections.abc import Coroutine
from dataclasses import dataclass, field, replace

import pytest

from catseye.app.engine import control
from catseye.app.engine.control import RunControl
from catseye.app.engine.halt import HaltLimits, HaltReport
from catseye.app.errors import InterruptedRunError, SafetyError, TerminatedRunError
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.errors import LinkError, RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotStatus
from tests.unit.app.engine.fakes import AWAY, FakeRobot, ManualClock


class Bench:
    def __init__(self) -> None:
        self.clock = ManualClock()
        self.robot = FakeRobot(self.clock)
        self.robot.state = replace(self.robot.state, servo_on=True)
        self.entered: list[tuple[ControlState, str]] = []
        self.control = RunControl(
            self.clock,
            lambda state, reason: self.entered.append((state, reason)),
            HaltLimits(standstill_s=0.5),
        )
        self.control.attach(self.robot)
        self.control.starting()
        self.control.started()

    def move(self) -> Coroutine[object, object, None]:
        return self.control.motion(self.gate, lambda: self.robot.move_joints(AWAY))

    async def gate(self) -> None:
        await asyncio.sleep(0)


@pytest.fixture
def bench() -> Bench:
    return Bench()


async def turns(count: int = 20) -> None:
    """Let every task go on as far as it can."""
    for _ in range(count):
        await asyncio.sleep(0)


async def until(bench: Bench, state: ControlState) -> None:
    await turns()
    assert bench.control.state == state


async def test_a_stop_during_a_move_reaches_the_robot_first(bench: Bench) -> None:
    bench.robot.blocks = True
    move = asyncio.create_task(bench.move())
    await bench.robot.moving.wait()
    bench.control.stop("F12")
    with pytest.raises(InterruptedRunError, match="F12"):
        await move
    await bench.control.halted()
    assert bench.robot.calls == ["move", "stop", "move cancelled"]
    assert bench.control.state == ControlState.STOPPED
    assert bench.control.reports[0].standstill


async def test_a_stop_needs_no_event_that_can_be_built(bench: Bench) -> None:
    def broken(_state: ControlState, _reason: str) -> None:
        raise ValueError("no event can be built")

    control = RunControl(bench.clock, broken, HaltLimits(standstill_s=0.5))
    control.attach(bench.robot)
    control.state = ControlState.HELD
    held = asyncio.create_task(control.checkpoint())
    await turns()
    with pytest.raises(ValueError, match="no event"):
        control.stop("F12")
    with pytest.raises(InterruptedRunError, match="F12"):
        await held
    await turns()
    assert "stop" in bench.robot.calls


async def test_no_motion_follows_a_stop(bench: Bench) -> None:
    bench.control.stop("F12")
    with pytest.raises(InterruptedRunError):
        await bench.move()
    await bench.control.halted()
    assert "move" not in bench.robot.calls


async def test_a_stop_during_the_gate_prevents_the_move(bench: Bench) -> None:
    looking = asyncio.Event()

    async def gate() -> None:
        looking.set()
        await asyncio.sleep(0)
        await asyncio.sleep(0)

    move = asyncio.create_task(bench.control.motion(gate, lambda: bench.robot.move_joints(AWAY)))
    await looking.wait()
    bench.control.stop("F12")
    with pytest.raises(InterruptedRunError):
        await move
    await bench.control.halted()
    assert "move" not in bench.robot.calls


async def test_a_hold_takes_effect_at_the_checkpoint(bench: Bench) -> None:
    bench.robot.blocks = False
    bench.control.hold("h")
    assert bench.control.state == ControlState.HOLDING
    waiting = asyncio.create_task(bench.move())
    await until(bench, ControlState.HELD)
    assert bench.robot.calls == []
    bench.control.unhold("go on")
    await waiting
    assert bench.robot.calls == ["move"]
    assert bench.control.state.value == "EXECUTE"


async def test_a_motion_begins_in_the_same_turn_its_gate_opens(bench: Bench) -> None:
    turns: list[str] = []

    async def gate() -> None:
        # Whatever forbids motion from here on finds it begun, and stops it.
        asyncio.get_running_loop().call_soon(turns.append, "another turn")

    async def action() -> list[str]:
        return list(turns)

    assert await bench.control.motion(gate, action) == []


@dataclass
class EndsAtStop(FakeRobot):
    """Its motion is refused some turns of the loop after a stop."""

    turns_later: int = 0
    stopped: asyncio.Event = field(default_factory=asyncio.Event)

    async def move_joints(self, target: Pose) -> None:
        self.calls.append(f"move to {target}")
        await self.stopped.wait()
        await turns(self.turns_later)
        raise RefusedError("stopped", 1)

    async def stop(self) -> None:
        await super().stop()
        self.stopped.set()


@pytest.mark.parametrize("turns_later", range(8))
async def test_a_motion_refused_at_any_turn_of_a_halt(bench: Bench, turns_later: int) -> None:
    robot = EndsAtStop(bench.clock)
    robot.state, robot.turns_later = bench.robot.state, turns_later
    bench.control.attach(robot)
    motion = asyncio.create_task(bench.control.motion(bench.gate, lambda: robot.move_joints(AWAY)))
    await turns()
    bench.control.interrupt("the door is open")
    await until(bench, ControlState.UNSUSPENDING)
    bench.control.stop("over")
    with pytest.raises(InterruptedRunError):
        await motion
    await bench.control.halted()


async def test_a_halt_that_fails_calls_for_the_emergency_stop(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def failing(*_: object) -> HaltReport:
        raise KeyError("theta1")

    monkeypatch.setattr(control, "halt", failing)
    bench.control.interrupt("the door is open")
    await until(bench, ControlState.ABORTED)
    assert "PRESS THE EMERGENCY STOP" in str(bench.control.ending)
    assert "PRESS THE EMERGENCY STOP" in bench.entered[-1][1]


@pytest.mark.parametrize(("anew", "state"), [(True, ControlState.SUSPENDING), (False, ControlState.EXECUTE)])
async def test_a_door_opened_while_starting_has_to_be_acknowledged(anew: bool, state: ControlState) -> None:
    starting = RunControl(ManualClock(), lambda _state, _reason: None, HaltLimits())
    starting.starting()
    starting.interrupt("the door is open", anew=anew)
    starting.started()
    assert starting.state == state
    assert starting.unacknowledged == ("the door is open" if anew else "")
    await starting.halted()


async def test_no_standstill_is_claimed_of_devices_not_ready() -> None:
    entered: list[tuple[ControlState, str]] = []
    starting = RunControl(ManualClock(), lambda state, reason: entered.append((state, reason)), HaltLimits())
    starting.starting()
    starting.abort(SafetyError("nobody answers"))
    await starting.halted()
    assert entered[-1] == (ControlState.ABORTED, "the devices were not ready, and nothing was moved")


async def test_many_reasons_are_counted_rather_than_listed(bench: Bench) -> None:
    for number in range(100):
        bench.control.interrupt(f"trouble {number}")
    assert bench.control.interruptions == 100
    assert bench.control.interruption.endswith("trouble 4; and 95 more")
    await bench.control.halted()


async def test_after_a_hold_the_gate_looks_again(bench: Bench) -> None:
    looks = 0

    async def gate() -> None:
        nonlocal looks
        looks += 1
        if looks == 1:
            bench.control.hold("h")

    waiting = asyncio.create_task(bench.control.motion(gate, lambda: bench.robot.move_joints(AWAY)))
    await until(bench, ControlState.HELD)
    bench.control.unhold("go on")
    await waiting
    assert looks == 2
    assert bench.robot.calls == ["move"]


async def test_the_ladder_of_ctrl_c_holds_then_stops_then_aborts(bench: Bench) -> None:
    bench.control.on_signal(signal.SIGINT)
    assert bench.control.state == ControlState.HOLDING
    bench.control.on_signal(signal.SIGINT)
    stopping = bench.control.state
    bench.control.on_signal(signal.SIGINT)
    assert (stopping, bench.control.state.value) == (ControlState.STOPPING, "ABORTING")
    with pytest.raises(InterruptedRunError, match="third"):
        await bench.control.checkpoint()
    await bench.control.halted()
    assert bench.control.state.value == "ABORTED"


async def test_a_second_ctrl_c_while_held_stops(bench: Bench) -> None:
    bench.control.on_signal(signal.SIGINT)
    waiting = asyncio.create_task(bench.control.checkpoint())
    await until(bench, ControlState.HELD)
    bench.control.on_signal(signal.SIGINT)
    with pytest.raises(InterruptedRunError):
        await waiting
    await bench.control.halted()
    assert bench.robot.calls[0] == "stop"
    assert bench.control.state == ControlState.STOPPED


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
async def test_termination_aborts(bench: Bench, number: signal.Signals) -> None:
    bench.control.on_signal(number)
    with pytest.raises(TerminatedRunError, match=number.name):
        await bench.control.checkpoint()
    await bench.control.halted()
    assert bench.control.state == ControlState.ABORTED


async def test_sigusr1_ends_a_hold(bench: Bench) -> None:
    bench.control.on_signal(signal.SIGINT)
    waiting = asyncio.create_task(bench.control.checkpoint())
    await until(bench, ControlState.HELD)
    bench.control.on_signal(signal.SIGUSR1)
    await waiting
    assert bench.control.state == ControlState.EXECUTE


async def test_a_suspension_waits_for_the_condition(bench: Bench) -> None:
    bench.control.suspend("interlock open")
    waiting = asyncio.create_task(bench.move())
    await turns()
    assert bench.robot.calls == []
    bench.control.condition_back("interlock closed")
    await waiting
    assert bench.robot.calls == ["move"]


async def suspended(bench: Bench, back: list[bool]) -> None:
    """Be suspended until the list of looks says that the condition is back."""

    async def look() -> bool:
        await asyncio.sleep(0)
        return back[0] if len(back) == 1 else back.pop(0)

    await bench.control.suspended("the air is too warm", look, 0.5)


async def test_a_suspension_ends_when_a_look_finds_the_condition_back(bench: Bench) -> None:
    await suspended(bench, [False, False, True])
    assert [state for state, _ in bench.entered[2:]] == [ControlState.SUSPENDED, ControlState.EXECUTE]
    assert bench.entered[-1][1] == "over: the air is too warm"
    assert bench.clock.time_s == 1.0
    await bench.move()
    assert bench.robot.pose == AWAY


async def test_a_hold_outlasts_a_suspension_whether_over_or_not(bench: Bench) -> None:
    back = [False]
    waiting = asyncio.create_task(suspended(bench, back))
    await until(bench, ControlState.SUSPENDED)
    bench.control.hold("operator")
    await until(bench, ControlState.HELD)
    bench.control.unhold("operator")
    # The condition is not back: after the hold the run is suspended again, not moving.
    await until(bench, ControlState.SUSPENDED)
    bench.control.hold("operator")
    back[0] = True
    await until(bench, ControlState.HELD)
    assert not waiting.done()
    bench.control.unhold("operator")
    await waiting
    assert bench.control.state == ControlState.EXECUTE


async def test_a_stop_ends_a_suspension(bench: Bench) -> None:
    waiting = asyncio.create_task(suspended(bench, [False]))
    await until(bench, ControlState.SUSPENDED)
    bench.control.stop("F12")
    with pytest.raises(InterruptedRunError, match="F12"):
        await waiting
    await bench.control.halted()
    assert bench.control.state == ControlState.STOPPED


async def test_a_motion_proceeds_after_a_suspension_at_its_gate(bench: Bench) -> None:
    looks = []

    async def gate() -> None:
        looks.append(bench.control.state)
        if len(looks) == 1:
            bench.control.suspend("the door is open")
            asyncio.get_running_loop().call_soon(bench.control.condition_back, "the door is closed")
            await turns(3)

    await bench.control.motion(gate, lambda: bench.robot.move_joints(AWAY))
    assert len(looks) >= 1
    assert bench.robot.pose == AWAY


async def test_a_stop_drops_every_command_under_way(bench: Bench) -> None:
    bench.robot.blocks = True
    commands = [
        asyncio.create_task(bench.control.command(asyncio.Event().wait())),
        asyncio.create_task(bench.move()),
    ]
    await bench.robot.moving.wait()
    bench.control.stop("F12")
    for ended in await asyncio.gather(*commands, return_exceptions=True):
        assert isinstance(ended, InterruptedRunError)
    assert bench.robot.calls.index("stop") < bench.robot.calls.index("move cancelled")
    await bench.control.halted()


async def test_the_drives_are_switched_off_when_standstill_is_not_confirmed(bench: Bench) -> None:
    bench.robot.blocks = bench.robot.ignores_stop = True
    move = asyncio.create_task(bench.move())
    await bench.robot.moving.wait()
    bench.control.stop("F12")
    with pytest.raises(InterruptedRunError):
        await move
    await bench.control.halted()
    assert bench.robot.calls[-1] == "servo off"
    assert bench.robot.calls.count("stop") > 1
    (report,) = bench.control.reports
    assert (report.standstill, report.servo_off) == (False, True)
    assert bench.clock.time_s < 2.0


async def test_a_robot_that_creeps_does_not_stand_still(bench: Bench) -> None:
    bench.robot.creeps = True
    bench.control.stop("F12")
    await bench.control.halted()
    assert bench.control.reports[0].servo_off


async def test_a_stop_that_cannot_be_sent_is_reported(bench: Bench) -> None:
    bench.robot.stop_error = LinkError("cable off")
    bench.robot.creeps = True
    bench.control.stop("F12")
    await bench.control.halted()
    assert "cable off" in bench.control.reports[0].text


async def test_an_unacknowledged_stop_does_not_delay_the_halt(bench: Bench) -> None:
    class DeafRobot(FakeRobot):
        async def stop(self) -> None:
            self.calls.append("stop")
            await asyncio.Event().wait()

    robot = DeafRobot(bench.clock, blocks=True)
    bench.control.attach(robot)
    move = asyncio.create_task(bench.control.motion(bench.gate, lambda: robot.move_joints(AWAY)))
    await robot.moving.wait()
    bench.control.stop("F12")
    await turns()
    bench.clock.advance(1.0)
    with pytest.raises(InterruptedRunError):
        await move
    # The looks at the robot hang in their own repeated stop: the halt is given up after a while.
    await turns()
    bench.clock.advance(6.0)
    await bench.control.halted()
    assert robot.calls == ["move", "stop", "move cancelled", "stop", "servo off"]
    assert "did not acknowledge" in bench.control.reports[0].text


async def test_a_hung_controller_is_given_up_after_seconds(bench: Bench) -> None:
    """Each question to a hung controller costs 2 s; nobody who ends a run waits half a minute for it."""

    async def hung() -> RobotStatus:
        bench.clock.advance(2.0)
        raise LinkError("no answer within 2 s")

    bench.robot.status = hung  # type: ignore[method-assign]  # a controller that hangs from now on
    bench.control.stop("F12")
    await bench.control.halted()
    assert bench.robot.calls == ["stop", "servo off"]
    assert bench.clock.time_s < 5.0


async def test_a_link_healed_during_a_halt_still_proves_standstill(bench: Bench) -> None:
    status, failures = bench.robot.status, [LinkError("cut off in the middle of a command")]

    async def healing() -> RobotStatus:
        bench.clock.advance(4.0)
        if failures:
            raise failures.pop()
        return await status()

    bench.robot.status = healing  # type: ignore[method-assign]  # a link that reconnects
    bench.control.stop("F12")
    await bench.control.halted()
    assert bench.control.reports[0].standstill
    assert bench.robot.calls == ["stop"]


async def test_a_cancelled_caller_stops_the_robot_before_it_ends(bench: Bench) -> None:
    bench.robot.blocks = True
    move = asyncio.create_task(bench.move())
    await bench.robot.moving.wait()
    move.cancel()
    with pytest.raises(asyncio.CancelledError):
        await move
    assert bench.robot.calls == ["move", "stop", "move cancelled"]
    assert bench.control.state == ControlState.ABORTED


async def test_motion_after_the_end_is_refused(bench: Bench) -> None:
    bench.control.done()
    with pytest.raises(SafetyError, match="COMPLETE"):
        await bench.move()


async def test_a_request_that_means_nothing_is_reported(bench: Bench) -> None:
    bench.control.unhold("SIGUSR1")
    assert bench.entered[-1] == (ControlState.EXECUTE, "unhold means nothing in state EXECUTE (SIGUSR1)")


async def test_only_a_clear_leaves_aborted(bench: Bench) -> None:
    bench.control.abort(SafetyError("alarm"))
    await bench.control.halted()
    bench.control.clear("the operator has looked")
    assert bench.control.state == ControlState.STOPPED
