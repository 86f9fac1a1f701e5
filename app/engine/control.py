"""The stop ladder: who may ask for what, and how a running command learns of it."""

import asyncio
import logging
import signal
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any, Final, TypeVar

from catseye.app.engine.halt import HaltLimits, HaltReport, halt
from catseye.app.engine.states import Effect, Trigger, transition
from catseye.app.engine.wait_time import WaitTime
from catseye.app.engine.waiting import cancel, uncancelled
from catseye.app.errors import (
    CatseyeError,
    HeldTooLongError,
    InterruptedRunError,
    SafetyError,
    TerminatedRunError,
)
from catseye.app.protocol.ladder import Rung, rung_of, top_text
from catseye.app.protocol.state import BEFORE_MOTION, ENDED, HELD, INTERRUPTED, ControlState
from catseye.drivers.links.guarding import GuardError
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import AlarmError, NotArrivedError, NotReadyError, RefusedError
from catseye.drivers.roles.robot import Robot

T = TypeVar("T")

_log = logging.getLogger(__name__)

SIGNALS: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1)
"""Signals that `RunControl.on_signal` understands."""

_WAITING = HELD | {ControlState.SUSPENDED} | INTERRUPTED
_IDLE = frozenset({ControlState.HELD, ControlState.SUSPENDED}) | INTERRUPTED

_HELD_BY_SIGNAL = "SIGINT: press Ctrl-C again to stop, send SIGUSR1 to go on"

_MOST_REASONS = 5
"""So many are listed in the question whether the arm may move again."""


class RunControl:
    """State of a run and the ways to change it; requests take effect at once, in the event loop.

    Args:
        on_change: called with each new state and its reason.
        limits: how long a halt may take.

    Attributes:
        state: where the run stands.
        ending: why the run ends early, raised by every further checkpoint; None while it goes on.
        reports: how each halt ended.
        moving: a motion is under way.
        interruption: why the surroundings stopped the robot last, every reason that came before somebody acknowledged
            them; empty when they never did.
        interruptions: how often they did, times included at which it stood already.
        unacknowledged: why nothing may move before somebody has acknowledged it; empty while nothing of that kind is.
        on_interrupted: asks whether to go on after an interruption and returns when `acknowledge` was called; without
            it somebody else has to call that.
        wait_time: how long it waits, and waited.
        waits: how often the run was held or suspended or asked something so far; somebody may have moved the arm
            meanwhile.
    """

    def __init__(
        self, clock: Clock, on_change: Callable[[ControlState, str], None], limits: HaltLimits | None = None
    ) -> None:
        self.state = ControlState.IDLE
        self.ending: CatseyeError | None = None
        self.reports: list[HaltReport] = []
        self._clock = clock
        self._on_change = on_change
        self._limits = limits or HaltLimits()
        self._robot: Robot | None = None
        self._commands: set[asyncio.Task[Any]] = set()
        self._halts: set[asyncio.Task[None]] = set()
        self._halting = 0
        self._changed = asyncio.Event()
        self._motion_permitted = False
        self._motion: asyncio.Timeout | None = None
        self._holds_first: list[str] = []
        self._hold_reason = ""
        self.moving = False
        self.interruption = ""
        self.interruptions = 0
        self.unacknowledged = ""
        self.on_interrupted: Callable[[], Awaitable[None]] | None = None
        self._reasons: list[str] = []
        self._interrupt_first: str | None = None
        self.waits = 0
        self.wait_time = WaitTime(clock)

    def attach(self, robot: Robot) -> None:
        """From now on a stop reaches this robot."""
        self._robot = robot

    def hold(self, reason: str) -> None:
        """Hold at the next checkpoint; the move under way ends by itself. An interruption comes first."""
        self._hold_reason = reason
        if self.state in INTERRUPTED:
            self._holds_first = [reason]
            self._on_change(self.state, f"held as soon as the interruption is acknowledged: {reason}")
            return
        self._apply(Trigger.HOLD, reason)

    def hold_before_motion(self, reason: str) -> None:
        """Hold; a run whose devices are not ready yet is held when they are, before anything moves."""
        if self.state in BEFORE_MOTION:
            self._holds_first.append(reason)
        else:
            self.hold(reason)

    def withdraw_hold(self, reason: str) -> None:
        """Withdraw what `hold_before_motion` was called with, as long as the devices are not ready."""
        if self.state in BEFORE_MOTION and reason in self._holds_first:
            self._holds_first.remove(reason)

    def unhold(self, reason: str) -> None:
        """Go on after a hold."""
        if self.state in INTERRUPTED:
            self._holds_first.clear()
        self._apply(Trigger.UNHOLD, reason)

    def suspend(self, reason: str) -> None:
        """Begin no new motion until a condition is back."""
        self._apply(Trigger.SUSPEND, reason)

    def condition_back(self, reason: str) -> None:
        """End a suspension."""
        self._apply(Trigger.CONDITION_BACK, reason)

    def interrupt(self, reason: str, *, anew: bool = False) -> None:
        """Stop the robot now; the run goes on when somebody has acknowledged that, held if it was held.

        Args:
            reason: why; one that is there already is no other interruption.
            anew: it is one all the same: what was over has happened again.
        """
        if self.state in INTERRUPTED:
            if anew or reason not in self._reasons:
                self._count_interruption(reason)
                self._on_change(self.state, reason)
            return
        if self.state in BEFORE_MOTION and anew:
            self._interrupt_first = reason
            return
        if transition(self.state, Trigger.INTERRUPT).state == self.state:
            return
        if self.state in HELD:
            self._holds_first = [self._hold_reason]
        self._reasons.clear()
        self._count_interruption(reason)
        self._apply(Trigger.INTERRUPT, reason)

    def acknowledge(self, reason: str) -> None:
        """Permit motion again after an interruption."""
        if self.state == ControlState.UNSUSPENDING:
            self.unacknowledged = ""
        self._apply(Trigger.ACKNOWLEDGE, reason)
        self._hold_if_asked()

    def stop(self, reason: str) -> None:
        """Stop the robot now and end the run."""
        self._end(Trigger.STOP, InterruptedRunError(reason))

    def give_up(self, reason: str) -> None:
        """Stop the robot now and end the run, which nobody lets go on."""
        self._end(Trigger.STOP, HeldTooLongError(reason))

    def abort(self, error: CatseyeError) -> None:
        """Stop the robot now and end the run without teardown."""
        self._end(Trigger.ABORT, error)

    def fault(self, error: CatseyeError) -> None:
        """Stop the robot now since something failed."""
        self._end(Trigger.FAULT, error)

    def climb(self, who: str = "") -> Rung | None:
        """Take the next rung of the stop ladder; return it, None when none is left.

        Args:
            who: asks for it; empty for a signal.
        """
        rung = rung_of(self.state)
        match rung:
            case Rung.HOLD:
                self.hold(f"{who} holds the run" if who else _HELD_BY_SIGNAL)
            case Rung.STOP:
                self.stop(f"{who or 'the operator'} stopped the run (Ctrl-C)")
            case Rung.ABORT:
                self.abort(InterruptedRunError(f"{who or 'the operator'} aborted the run (third Ctrl-C)"))
            case None:
                pass
        return rung

    def on_signal(self, number: int) -> None:
        """Climb the stop ladder at SIGINT, abort at SIGTERM and SIGHUP; SIGUSR1 ends a hold."""
        name = signal.Signals(number).name
        if number == signal.SIGUSR1:
            self.unhold(name)
        elif number == signal.SIGINT:
            if self.climb() is None:
                self._on_change(self.state, top_text(self.state))
        else:
            self.abort(TerminatedRunError(f"the run was aborted by {name}; the robot was stopped"))

    def starting(self) -> None:
        """The devices are being connected."""
        self._apply(Trigger.START, "devices are being connected")

    def started(self) -> None:
        """The devices are ready."""
        self._apply(Trigger.STARTED, "devices are ready")
        if self._interrupt_first is not None:
            self.interrupt(self._interrupt_first)
        self._hold_if_asked()

    def done(self) -> None:
        """The procedure has come to its end."""
        self._apply(Trigger.DONE, "the procedure has come to its end")

    def clear(self, reason: str) -> None:
        """Leave ABORTED; only an operator decides that."""
        self._apply(Trigger.CLEAR, reason)
        self._apply(Trigger.CLEARED, reason)

    async def checkpoint(self) -> None:
        """Wait while the run is held, suspended or interrupted.

        Raises:
            CatseyeError: the run ends: stopped, aborted or failed.
        """
        self.raise_ending()
        while self.state in _WAITING:
            if self.state == ControlState.HOLDING:
                self._apply(Trigger.HELD, f"at a checkpoint: {self._hold_reason}")
            self.waits += 1
            if self.state == ControlState.UNSUSPENDING and self.on_interrupted is not None:
                await self.on_interrupted()
            else:
                self._changed.clear()
                await self._changed.wait()
            self.raise_ending()
        if self.state == ControlState.UNHOLDING:
            self._apply(Trigger.RESUMED, "the operator goes on")

    async def suspended(self, reason: str, back: Callable[[], Awaitable[bool]], poll_s: float) -> None:
        """Begin no motion until a condition is back; a hold meanwhile outlasts it.

        Args:
            reason: what is wrong and what to do about it.
            back: looks at the condition; it must not wait at a checkpoint.
            poll_s: between two looks, s of the clock.

        Raises:
            CatseyeError: the run ends.
        """
        await self.checkpoint()
        self.suspend(reason)
        self.waits += 1
        while not await back():
            self.raise_ending()
            await self._clock.sleep(poll_s)
            if self.state in _WAITING - {ControlState.SUSPENDED}:
                await self.checkpoint()
            self.raise_ending()
            if self.state == ControlState.EXECUTE:
                self.suspend(reason)
        self.raise_ending()
        if self.state == ControlState.SUSPENDED:
            self.condition_back(f"over: {reason}")
        await self.checkpoint()

    async def command(self, action: Coroutine[Any, Any, T]) -> T:
        """Let devices do something that a stop drops, after it has stopped the robot.

        Raises:
            CatseyeError: the run ends.
        """
        task = asyncio.create_task(action)
        self._commands.add(task)
        try:
            await asyncio.wait({task})
        finally:
            if not task.done():
                # A command inside a command is cancelled together with it by a stop, which stays a stop.
                if self.ending is None:
                    self.abort(TerminatedRunError("the run was cancelled; the robot was stopped"))
                await uncancelled(self.halted())
                await cancel(task)
            self._commands.discard(task)
        if self.ending is not None and not task.cancelled() and task.exception() is not None:
            raise self.ending from task.exception()
        self.raise_ending()
        return task.result()

    async def motion(
        self, gate: Callable[[], Coroutine[Any, Any, None]], action: Callable[[], Coroutine[Any, Any, T]]
    ) -> T:
        """Run a command that moves the robot; it begins only while motion is permitted.

        Args:
            gate: looks whether the motion may begin; it looks again after each hold and each interruption.
            action: moves the robot; called again when an interruption has cut it short and is acknowledged.

        Raises:
            CatseyeError: the run ends, or the gate refuses.
        """
        while True:
            await self.checkpoint()
            moved = await self.command(self._gated(gate, action))
            if moved:
                return moved[0]
            # It may wait, or wait no longer; both times the gate is asked again.
            if self.state not in _WAITING and not self._motion_permitted:
                raise SafetyError(f"no motion may begin in state {self.state}: the procedure is over")

    async def _gated(
        self, gate: Callable[[], Coroutine[Any, Any, None]], action: Callable[[], Coroutine[Any, Any, T]]
    ) -> tuple[T] | tuple[()]:
        """Look, then move if motion is still permitted; nothing comes back when it is not."""
        await gate()
        if not self._motion_permitted:
            return ()
        self.moving = True
        try:
            return await self._interruptible(action)
        finally:
            self.moving = False

    async def _interruptible(self, action: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T] | tuple[()]:
        """Run an action to its end; nothing comes back from one that an interruption has cut short."""
        before = self.interruptions
        # A limit in place of a task: a task's turns of the loop come on top of every motion.
        self._motion = limit = asyncio.timeout(None)
        try:
            try:
                async with limit:
                    return (await action(),)
            finally:
                self._motion = None
        except (TimeoutError, RefusedError, NotArrivedError) as error:
            # What the guard has done interrupts the run in the next turn of the loop.
            await asyncio.sleep(0)
            if self.interruptions == before or not (limit.expired() or _cut_short(error)):
                raise
            return ()

    async def halted(self) -> None:
        """Wait until every halt under way has ended."""
        while self._halts:
            await asyncio.wait(set(self._halts))

    def _end(self, trigger: Trigger, error: CatseyeError) -> None:
        changes = transition(self.state, trigger).state != self.state
        if changes:
            self.ending = error
        before_start = self.state == ControlState.IDLE
        self._apply(trigger, str(error))
        if before_start:
            # Nothing has moved: there is no halt that would drop what is under way.
            self._drop_command()

    def _apply(self, trigger: Trigger, reason: str) -> None:
        result = transition(self.state, trigger)
        changes = result.state != self.state
        self.state = result.state
        try:
            for effect in result.effects:
                self._do(effect, trigger, reason)
        finally:
            # Publishing comes last, and what fails in it keeps nobody waiting at a checkpoint.
            if changes:
                self.wait_time.count(idle=self.state in _IDLE, reason=f"{self.state}: {reason}")
            self._changed.set()

    def _hold_if_asked(self) -> None:
        reasons, self._holds_first = self._holds_first, []
        if reasons:
            self.hold("; ".join(reasons))

    def _count_interruption(self, reason: str) -> None:
        if reason not in self._reasons:
            self._reasons.append(reason)
        more = len(self._reasons) - _MOST_REASONS
        text = "; ".join(self._reasons[:_MOST_REASONS])
        self.interruption = self.unacknowledged = f"{text}; and {more} more" if more > 0 else text
        self.interruptions += 1

    def _do(self, effect: Effect, trigger: Trigger, reason: str) -> None:
        match effect:
            case Effect.PERMIT_MOTION:
                self._motion_permitted = True
            case Effect.FORBID_MOTION:
                self._motion_permitted = False
            case Effect.STOP_ROBOT:
                self._begin(self._halt())
            case Effect.STOP_MOTION:
                self._begin(self._rest())
            case Effect.PUBLISH:
                self._on_change(self.state, reason)
            case Effect.REPORT_IGNORED:
                self._on_change(self.state, f"{trigger} means nothing in state {self.state} ({reason})")

    def _begin(self, halting: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(halting)
        self._halts.add(task)
        task.add_done_callback(self._halts.discard)

    async def _rest(self) -> None:
        """Bring the robot to rest; a standstill that nobody sees is more than an interruption."""
        if self._robot is not None:
            report = await self._halted(self._robot, self._drop_motion)
            if not report.standstill:
                self.reports.append(report)
                self.abort(SafetyError(f"{self.interruption}; {report.text}"))
        if self.state == ControlState.SUSPENDING:
            self._apply(Trigger.INTERRUPTED, f"the arm stands: {self.interruption}")

    async def _halt(self) -> None:
        self._halting += 1
        try:
            if self._robot is not None:
                self.reports.append(await self._halted(self._robot, self._drop_command))
            else:
                self._drop_command()
        finally:
            self._halting -= 1
        # An abort during a stop has a halt of its own: the last one to end says where the run stands.
        if self._halting == 0 and self.state not in ENDED:
            unconfirmed = [report.text for report in self.reports if not report.standstill]
            sure = (
                "the robot stands"
                if self._robot is not None
                else "the devices were not ready, and nothing was moved"
            )
            reason = unconfirmed[-1] if unconfirmed else sure
            self._apply(Trigger.ABORTED if self.state == ControlState.ABORTING else Trigger.STOPPED, reason)

    async def _halted(self, robot: Robot, drop: Callable[[], None]) -> HaltReport:
        try:
            return await halt(robot, self._clock, self._limits, drop)
        except Exception as error:  # noqa: BLE001  # a fault of the program: only the operator can stop the arm now
            _log.exception("bringing the robot to rest failed")
            text = f"the robot may still move: PRESS THE EMERGENCY STOP (fault of the program: {error!r})"
            return HaltReport(standstill=False, servo_off=False, text=text)

    def _drop_command(self) -> None:
        for command in self._commands:
            command.cancel()

    def _drop_motion(self) -> None:
        if self._motion is not None and not self._motion.expired():
            self._motion.reschedule(asyncio.get_running_loop().time())

    def raise_ending(self) -> None:
        """Raise why the run ends, if it does.

        Raises:
            CatseyeError: the run ends: stopped, aborted or failed.
        """
        if self.ending is not None:
            raise self.ending


def _cut_short(error: Exception) -> bool:
    """Return whether a motion ended as one does that a STOP has overtaken."""
    return isinstance(error, GuardError) or not isinstance(error, (AlarmError, NotReadyError, TimeoutError))
