"""Bringing the robot to a standstill, and not believing it until it is seen."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from catseye.app.engine.waiting import cancel, within
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.pose import Pose, is_at
from catseye.drivers.roles.robot import Robot

PRESS: Final = "PRESS THE EMERGENCY STOP: standstill is not confirmed"
"""Begins what is said where nobody has seen the arm stand and its drives are not known to be off."""

FAILURES = (DeviceError, OSError, TimeoutError)
"""What a device may raise on the way to a standstill; none of it ends the way."""

_SAME_PLACE = 0.01
_FEWEST_POLLS = 5
_MOST_FAILURES = 2
"""A look that fails takes as long as a link waits for an answer; after one a link may have healed."""


@dataclass(frozen=True)
class HaltLimits:
    """How long a halt may take.

    Attributes:
        taken_s: until the controller has taken the stop; then the halt goes on without waiting.
        standstill_s: until standstill is seen; then the drives are switched off.
        poll_s: between two looks at the robot.
        hang_s: until a device that does not answer at all is given up.
    """

    taken_s: float = 1.0
    standstill_s: float = 3.0
    poll_s: float = 0.05
    hang_s: float = 6.0

    def at_speed(self, speed: float) -> "HaltLimits":
        """Return the same real times as seconds of a clock that runs faster: links do not run faster with it."""
        return HaltLimits(
            self.taken_s * speed, self.standstill_s * speed, self.poll_s * speed, self.hang_s * speed
        )


@dataclass(frozen=True)
class HaltReport:
    """How a halt ended.

    Attributes:
        standstill: two looks in a row saw the robot at rest.
        servo_off: the drives were switched off since standstill was not seen.
        text: what went wrong; empty for a plain stop.
    """

    standstill: bool
    servo_off: bool
    text: str


async def halt(
    robot: Robot, clock: Clock, limits: HaltLimits, cancel_command: Callable[[], None]
) -> HaltReport:
    """Stop the robot first, then drop the command under way, then look until it stands.

    Args:
        cancel_command: drops what the program is doing with the devices.
    """
    stop = asyncio.create_task(robot.stop())
    timer = asyncio.create_task(clock.sleep(limits.taken_s))
    try:
        await asyncio.wait({stop, timer}, return_when=asyncio.FIRST_COMPLETED)
        cancel_command()
        standstill = await _bounded(clock, limits, robot)
        if standstill:
            return HaltReport(True, False, _trouble(stop))
        return await _switch_off(robot, clock, limits, _trouble(stop))
    finally:
        await cancel(stop, timer)


async def _bounded(clock: Clock, limits: HaltLimits, robot: Robot) -> bool:
    try:
        return await within(clock, limits.hang_s, _stands_still(robot, clock, limits))
    except FAILURES:
        return False


async def _stands_still(robot: Robot, clock: Clock, limits: HaltLimits) -> bool:
    # At least a few looks are made: bench time may run so fast that the limit passes during one answer.
    deadline_s = clock.monotonic_s() + limits.standstill_s
    before: Pose | None = None
    polls = failed = 0
    while clock.monotonic_s() < deadline_s or (polls < _FEWEST_POLLS and failed < _MOST_FAILURES):
        try:
            now = await _place_at_rest(robot)
        except FAILURES:
            # A link that was cut off in the middle of a command heals with the next question.
            now = None
            failed += 1
        if now is not None and before is not None and is_at(before, now, _SAME_PLACE):
            return True
        before = now
        polls += 1
        await clock.sleep(limits.poll_s)
    return False


async def _place_at_rest(robot: Robot) -> Pose | None:
    if (await robot.status()).running:
        # A motion command that was on its way when the stop overtook it is stopped here.
        await robot.stop()
        return None
    return await robot.joints()


async def _switch_off(robot: Robot, clock: Clock, limits: HaltLimits, trouble: str) -> HaltReport:
    try:
        await within(clock, limits.hang_s, robot.servo(on=False))
    except FAILURES as error:
        # A link that is gone fails both; its reason is stated once.
        why = "" if str(error) in trouble else f" ({error})"
        text = f"{PRESS}, and the drives do not switch off{why}"
        return HaltReport(False, False, f"{text}. {trouble}" if trouble else text)
    text = f"standstill was not confirmed in {limits.standstill_s:g} s: the drives were switched off"
    return HaltReport(False, True, f"{text}; look at the robot before going on. {trouble}".strip())


def _trouble(stop: "asyncio.Task[None]") -> str:
    if not stop.done():
        return "The controller did not acknowledge the stop."
    error = stop.exception() if not stop.cancelled() else None
    return f"The stop was answered with: {error}" if error else ""
