"""The drives at the end of a run: off, or left on and said."""

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
        text: what a person has to know.
    """

    on: bool
    text: str


_KEPT = "the drives stay on: the arm holds its place and can be moved at once"


async def leave_drives(robot: Robot, clock: Clock, limit_s: float, *, keep: bool) -> DrivesLeft:
    """Switch the drives of a robot that stands off, unless they are to be kept.

    Args:
        limit_s: for the answer, s of the clock.
    """
    if keep:
        return DrivesLeft(True, _KEPT)
    try:
        await within(clock, limit_s, robot.servo(on=False))
    except FAILURES as error:
        return DrivesLeft(
            True, f"the drives are not certain to be off: switch them off at the controller ({error})"
        )
    return DrivesLeft(False, "the drives are off")
