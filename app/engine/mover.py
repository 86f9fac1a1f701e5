"""Motions of a run: through stop ladder and gate, from where the arm is known to stand."""

import math
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

from catseye.app.engine.control import RunControl
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.stepping import Step
from catseye.app.errors import ConditionLostError, InterruptionError, UnwalkedError
from catseye.app.files.crash_points import crash_point
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.pose import SAME_PLACE, Axes, Pose, is_at, pose_text
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.context import Stepped
from catseye.procedures.kit.errors import ArmMovedError, StepCutShortError

T = TypeVar("T")

_BESIDE = 0.5
"""An arm that is stopped, or passes a corner of its way, stays nearer to it than this, deg or mm; whoever moves it by
hand seldom does."""


class Mover:
    """Drives ways; every way is checked from where the procedure knows the arm to stand.

    After a wait the arm need not stand there any more. After an interruption the rest of the way is driven if the
    arm stands on it.

    Args:
        wait_until: suspends the run until a condition is back.
        timed: awaits a motion and takes its time.
        waive: has somebody say why the arm may be driven where it was not walked.
        first: called with where the arm stands, if that is known, and the way that it is led from there first.
    """

    def __init__(
        self,
        robot: Robot,
        axes: Axes,
        control: RunControl,
        gate: MotionGate,
        clock: Clock,
        wait_until: Callable[[str, Callable[[], Awaitable[bool]]], Awaitable[None]],
        timed: Callable[[Awaitable[None]], Awaitable[None]],
        waive: Callable[[UnwalkedError], Awaitable[None]],
        first: Callable[[Pose | None, Sequence[Pose]], Awaitable[None]],
    ) -> None:
        self._robot = robot
        self._axes = axes
        self._control = control
        self._gate = gate
        self._clock = clock
        self._wait_until = wait_until
        self._timed = timed
        self._waive = waive
        self._first = first
        self._begun = False
        self._stood: _Stood | None = None

    def stands(self, here: Pose, waits: int) -> None:
        """Take note of where the procedure knows the arm to stand.

        Args:
            waits: of the control, before they were asked for.
        """
        self._stood = _Stood(here, waits)

    async def drive(self, way: Sequence[Pose]) -> None:
        """Drive a way; while a condition is missing the run is suspended and the gate asked again.

        Raises:
            LimitError: a target is outside the limits.
            SafetyError: the controller may not move.
            ArmMovedError: the arm was moved while the run waited, or was stopped beside its way.
        """
        motion = _Motion(self, way)
        await self._pass(motion.look, motion.move)

    async def step(self, step: Step) -> Stepped:
        """Send a relative motion once; while a condition is missing the run is suspended and the gate asked again.

        The gate clears the way to the farthest place where it may end. It ends near a place, not at it: from then on
        the arm is known to stand where the controller reports it.

        Raises:
            LimitError: it may end outside the limits.
            SafetyError: the controller may not move.
            StepCutShortError: the surroundings stopped the arm on the way.
            ArmMovedError: the arm was moved while the run waited.
        """
        motion = _Relative(self, step)
        return await self._pass(motion.look, motion.move)

    async def _pass(
        self, look: Callable[[], Coroutine[Any, Any, None]], move: Callable[[], Coroutine[Any, Any, T]]
    ) -> T:
        while True:
            try:
                moved = await self._control.motion(look, move)
            except ConditionLostError as error:
                await self._wait_until(str(error), self._gate.conditions_hold)
            except UnwalkedError as error:
                await self._waive(error)
            except InterruptionError as error:
                self._control.interrupt(str(error))
            else:
                crash_point("after-motion")
                return moved

    async def look(self, motion: "_Motion") -> None:
        """Check that a motion may begin, or go on."""
        waits = self._control.waits
        if self._stood is None and motion.start is not None:
            here = await self._robot.joints()
            motion.ahead = _rest(self._axes, motion.start, motion.ahead, here)
            self._stood = _Stood(here, waits)
        elif self._stood is not None and waits != self._stood.waits:
            self._stood.require(self._axes, await self._robot.joints())
        await self._clear(None if self._stood is None else self._stood.pose, motion.ahead)

    async def move(self, motion: "_Motion") -> None:
        """Move along what is left of a way."""
        motion.start, self._stood = None if self._stood is None else self._stood.pose, None
        ahead, robot = motion.ahead, self._robot
        if len(ahead) > 1:
            await self._timed(robot.follow(ahead))
        else:
            await self._timed(robot.move_joints(ahead[0]))
        self._stood = _Stood(ahead[-1], self._control.waits, SAME_PLACE + robot.read_back_limit)

    async def look_before(self, motion: "_Relative") -> None:
        """Check that a relative motion may begin, from where the arm is measured to stand now."""
        if motion.sent:
            raise StepCutShortError(
                f"the step of {motion.step.text} was cut short and is not completed: what the arm has done of it is "
                "unknown; measure this series again from its beginning"
            )
        waits, here = self._control.waits, await self._robot.joints()
        if self._stood is not None and waits != self._stood.waits:
            self._stood.require(self._axes, here)
        await self._clear(here, (motion.step.farthest(here),))
        motion.start, self._stood = here, _Stood(here, waits)

    async def move_by(self, motion: "_Relative") -> Stepped:
        """Send a relative motion that was looked at."""
        before, step = motion.start, motion.step
        motion.sent, self._stood = True, None
        commanded, sent_s = step.commanded(before), self._clock.monotonic_s()
        await self._timed(step.send(before, commanded))
        ended_s, waits = self._clock.monotonic_s(), self._control.waits
        after = await self._robot.joints()
        self._stood = _Stood(after, waits)
        return Stepped(before, commanded, sent_s, ended_s, after)

    async def _clear(self, here: Pose | None, ahead: Sequence[Pose]) -> None:
        await self._gate.require(*ahead, here=here)
        if not self._begun:
            self._begun = True
            await self._first(here, ahead)


@dataclass(frozen=True)
class _Stood:
    """Where the arm is known to stand.

    Attributes:
        pose: read back, or where its last motion was sent to.
        waits: of the control then.
        beside: how far an axis may be read back from it while nobody moves the arm, deg or mm.
    """

    pose: Pose
    waits: int
    beside: float = SAME_PLACE

    def require(self, axes: Axes, here: Pose) -> None:
        """Refuse to drive on from where nobody planned to be."""
        if not is_at(here, self.pose, self.beside):
            raise ArmMovedError(
                "the arm was moved while the run was held or suspended or a question was open: it stands at "
                f"{pose_text(axes, here)} and was left at {pose_text(axes, self.pose)}; the rest of its way was not "
                "driven; continue with catseye resume, and leave the arm alone while a run is under way"
            )


class _Relative:
    """One relative motion that is sent at most once."""

    def __init__(self, mover: Mover, step: Step) -> None:
        self.step = step
        self.start: Pose = ()
        self.sent = False
        self._mover = mover

    async def look(self) -> None:
        await self._mover.look_before(self)

    async def move(self) -> Stepped:
        return await self._mover.move_by(self)


class _Motion:
    """One motion that may be cut short and gone on with."""

    def __init__(self, mover: Mover, way: Sequence[Pose]) -> None:
        self.ahead = tuple(way)
        self.start: Pose | None = None
        self._mover = mover

    async def look(self) -> None:
        await self._mover.look(self)

    async def move(self) -> None:
        await self._mover.move(self)


def _rest(axes: Axes, start: Pose, way: Sequence[Pose], here: Pose) -> tuple[Pose, ...]:
    rest = rest_of_way(start, way, here)
    if rest is None:
        raise ArmMovedError(
            f"the arm was stopped and stands at {pose_text(axes, here)} now, beside the way that it was on from "
            f"{pose_text(axes, start)} to {pose_text(axes, way[-1])}; the rest was not driven; continue with "
            "catseye resume"
        )
    return rest


def rest_of_way(start: Pose, way: Sequence[Pose], here: Pose) -> tuple[Pose, ...] | None:
    """Return the targets that are still ahead, so that what is driven is a part of the way that was checked.

    Args:
        way: its targets; between them all joints move in proportion.

    Returns:
        None when the arm does not stand on the way.
    """
    beside = [_beside(a, b, here) for a, b in pairwise((start, *way))]
    nearest = min(range(len(beside)), key=beside.__getitem__)
    return tuple(way[nearest:]) if beside[nearest] <= _BESIDE else None


def _beside(a: Pose, b: Pose, here: Pose) -> float:
    """Return how far a place is beside a leg: the largest difference of a joint to the leg's nearest place."""
    along = [to - at for at, to in zip(a, b, strict=True)]
    length2 = math.fsum(step * step for step in along)
    passed = math.fsum((now - at) * step for now, at, step in zip(here, a, along, strict=True))
    share = min(1.0, max(0.0, passed / length2)) if length2 > 0.0 else 0.0
    return max(abs(now - at - share * step) for now, at, step in zip(here, a, along, strict=True))
