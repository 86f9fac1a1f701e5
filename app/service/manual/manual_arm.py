"""An arm that is ready, moved by steps and holds, one motion at a time."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Final, Literal, Protocol

from catseye.app.engine.halt import HaltLimits
from catseye.app.errors import InterruptedRunError, SafetyError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer, Moving, Stepped
from catseye.app.protocol.requests import JogHold, JogStep
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.manual.approach import Approach
from catseye.app.service.manual.hold import Hold, Sight
from catseye.app.service.manual.jog_gate import JogGate
from catseye.app.service.manual.manual_motion import ManualMotion
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.errors import ManualStepError
from catseye.procedures.kit.system import System

SILENCE_S: Final = 0.5
"""A step whose client gives no sign of life for so long is stopped, real s."""

_TICK_S = 0.05


class MotionListener(Protocol):
    """Called with what becomes of motions."""

    def moves(self, joint: str | None, reason: str) -> None:
        """Something begins to move, or stands again and why."""
        ...

    def failed(self, error: Exception) -> None:
        """A motion was ended by something that ends the jog too."""
        ...

    def unsafe(self, text: str) -> None:
        """The arm is not certain to stand."""
        ...


class ManualArm:
    """Moves an arm by hand.

    Args:
        gate: of every motion.
        clock: real time.
        limits: how long a halt may take.
        listener: is called with what becomes of motions.

    Attributes:
        motion: under way; None while the arm stands.
    """

    def __init__(
        self,
        robot: Robot,
        system: System,
        gate: JogGate,
        clock: Clock,
        limits: HaltLimits,
        listener: MotionListener,
    ) -> None:
        self.motion: ManualMotion | None = None
        self._robot = robot
        self._system = system
        self._gate = gate
        self._clock = clock
        self._limits = limits
        self._listener = listener
        self._task: asyncio.Task[Answer] | None = None

    def step(self, request: JogStep, heard_s: Callable[[], float]) -> "asyncio.Task[Answer]":
        """Begin a step; the result is there when the arm stands.

        Args:
            heard_s: when its client gave its last sign of life, on the clock.

        Raises:
            RefusedError: the arm is moving.
        """
        if self.motion is not None:
            raise RefusedError(f"{self.motion.joint} is moving: wait until the arm stands, or stop it")
        motion = ManualMotion(request.joint, self._robot, self._clock, self._limits)
        return self._begin(motion, self._step(motion, request, heard_s))

    def hold(self, request: JogHold) -> "Answer | asyncio.Future[Answer]":
        """Keep a joint moving, or stop; the result is there when it has been set going.

        Raises:
            RefusedError: a step is under way, there is no such axis to move, or the robot stops by itself only after
                a whole motion.
        """
        motion = self.motion
        if request.direction == 0:
            if motion is not None:
                self._release(motion, "released")
            return Answer()
        if motion is None:
            return self._begin_hold(request)
        if motion.hold is None:
            raise RefusedError(
                f"a step of {motion.joint} is under way: wait until the arm stands, or stop it"
            )
        if (motion.hold.joint, motion.hold.direction) == (request.joint, request.direction):
            motion.hold.feed()
        else:
            motion.hold.release("another joint or direction is asked for")
        return Answer()

    def stop(self, reason: str) -> None:
        """Stop the robot now if a motion is under way."""
        if self.motion is not None:
            self.motion.stop(reason)

    def break_off(self, error: Exception) -> None:
        """Stop the robot now if a motion is under way, since something forbids it."""
        if self.motion is not None:
            self.motion.break_off(error)

    async def at_rest(self) -> None:
        """Wait until no motion is under way."""
        if self._task is not None:
            await asyncio.wait({self._task})

    def _release(self, motion: ManualMotion, reason: str) -> None:
        if motion.hold is not None:
            motion.hold.release(reason)
        else:
            motion.stop("the step was stopped")

    def _begin_hold(self, request: JogHold) -> "asyncio.Future[Answer]":
        if not self._robot.abilities.jogs:
            raise RefusedError(
                "this robot's driver knows no jog that ends by itself when nobody feeds it: move by steps"
            )
        sight = Sight(self._robot.joints, self._gate.require_permission)
        try:
            number = self._system.axis_number(request.joint)
        except ManualStepError as error:
            raise refusal_of(error) from error
        axis = self._gate.axes[number]
        way: Literal[-1, 1] = 1 if request.direction > 0 else -1
        approach = Approach(axis.range, way, axis.speed * self._gate.percent / 100.0)
        hold = Hold(self._robot, axis, number, approach, sight, self._clock)
        motion = ManualMotion(request.joint, self._robot, self._clock, self._limits, hold)
        answer: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        task = self._begin(motion, self._hold(motion, hold, answer))
        task.add_done_callback(lambda ended: _settle(answer, ended, hold))
        return answer

    def _begin(self, motion: ManualMotion, work: Coroutine[Any, Any, Answer]) -> "asyncio.Task[Answer]":
        self.motion = motion
        self._gate.belong_to(motion.require_unstopped)
        self._task = asyncio.create_task(self._conducted(motion, work))
        return self._task

    async def _conducted(self, motion: ManualMotion, work: Coroutine[Any, Any, Answer]) -> Answer:
        reason = ""
        try:
            return await work
        except Exception as error:
            reason = str(error)
            if motion.unconfirmed:
                self._listener.unsafe(motion.unconfirmed)
            elif motion.began and not isinstance(error, InterruptedRunError):
                self._listener.failed(error)
            raise refusal_of(error) from error
        finally:
            self.motion = None
            if motion.began:
                self._listener.moves(None, motion.hold.reason if motion.hold and not reason else reason)

    async def _step(self, motion: ManualMotion, request: JogStep, heard_s: Callable[[], float]) -> Answer:
        targets: list[Pose] = []

        async def gate() -> None:
            here = await self._robot.joints()
            targets[:] = [self._system.step_target(here, request.joint, request.by, request.aim)]
            await self._gate.require(*targets, here=here)

        async def move() -> None:
            self._listener.moves(request.joint, "")
            await self._robot.move_joints(targets[0])

        async def alive() -> None:
            await self._until_silent(heard_s)

        await motion.carry_out(gate, move, alive)
        return Stepped(joints=tuple(await self._robot.joints()))

    async def _hold(self, motion: ManualMotion, hold: Hold, answer: "asyncio.Future[Answer]") -> Answer:
        def begun() -> None:
            self._listener.moves(hold.joint, "")
            if not answer.done():
                answer.set_result(Moving(moving=hold.joint))

        async def gate() -> None:
            here = await self._robot.joints()
            hold.end_at(*self._gate.clear_part(here, hold.at_limit(here)))
            await self._gate.require(hold.at_limit(here), here=here)
            await hold.require_room()

        hold.on_begun = begun
        await motion.carry_out(gate, hold.move)
        return Answer()

    async def _until_silent(self, heard_s: Callable[[], float]) -> None:
        begun_s = self._clock.monotonic_s()
        while self._clock.monotonic_s() - max(begun_s, heard_s()) <= SILENCE_S:
            await self._clock.sleep(_TICK_S)
        raise SafetyError(
            f"the client sent nothing for {SILENCE_S:g} s during a step: the arm was stopped; a client has to ping "
            "more often while it steps"
        )


def _settle(answer: "asyncio.Future[Answer]", ended: "asyncio.Task[Answer]", hold: Hold) -> None:
    """Answer a hold that ended before it had been set going."""
    error = None if ended.cancelled() else ended.exception()
    if answer.done():
        return
    if error is not None:
        answer.set_exception(error)
    else:
        answer.set_exception(RefusedError(f"{hold.joint} was not moved: {hold.reason}", ExitCode.INTERRUPTED))
