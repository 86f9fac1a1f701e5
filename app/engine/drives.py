"""The drives at the end of a run: off, left on, or left to an operator; which of them is said."""

from dataclasses import dataclass

from catseye.app.engine.halt import FAILURES
from catseye.app.engine.waiting import within
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.robot import Robot


@dataclass(frozen=True)
class DrivesLeft:
    """What became of the drives.

    Attributes:
        on: they are on, or not certain to be off.
        switched: a program is able to switch them off later.
        text: what a person has to know.
    """

    on: bool
    text: str
    switched: bool = True


_KEPT = "the drives stay on: the arm holds its place and can be moved at once"


async def leave_drives(robot: Robot, clock: Clock, limit_s: float, *, keep: bool) -> DrivesLeft:
    """Switch the drives of a robot that stands off, unless they are to be kept or nobody but an operator can.

    Args:
        limit_s: for the answer, s of the clock.
    """
    if not robot.abilities.switches_drives:
        return await _leave_at_rest(robot, clock, limit_s)
    if keep:
        return DrivesLeft(True, _KEPT)
    try:
        await within(clock, limit_s, robot.servo(on=False))
    except FAILURES as error:
        return DrivesLeft(
            True, f"the drives are not certain to be off: switch them off at the controller ({error})"
        )
    return DrivesLeft(False, "the drives are off")


async def _leave_at_rest(robot: Robot, clock: Clock, limit_s: float) -> DrivesLeft:
    try:
        text = await within(clock, limit_s, robot.rest())
    except FAILURES as error:
        text = (
            "what holds the arm is not known, and this program switches no drives of it: switch them off at the "
            f"controller before anybody goes there ({error})"
        )
    return DrivesLeft(True, text, switched=False)
