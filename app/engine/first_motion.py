"""Before the first motion of a process: an arm that somebody else moves is not driven."""

from collections.abc import Awaitable, Callable
from typing import Final

from catseye.app.errors import SafetyError
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.pose import Pose, is_at
from catseye.drivers.roles.robot import Robot, RobotStatus

REST_S: Final = 0.3
"""For so long the joints have to stay the same, real s."""

PATIENCE_S: Final = 30.0
"""A motion that a dead process has left behind may come to its end, real s."""

_POLL_S = 0.1
_SAME_PLACE = 0.01
"""Rounding of what a controller reports, deg or mm."""


async def require_rest(
    robot: Robot, clock: Clock, speed: float, warn: Callable[[str], Awaitable[None]]
) -> Pose:
    """Wait until the arm stands and no program but our own runs; return where it stands.

    Args:
        speed: seconds of the clock in one real second.
        warn: called once with the reason when the arm is not at rest.

    Raises:
        SafetyError: it does not come to rest, or another program runs.
        DeviceError: the controller does not answer.
    """
    begun_s = clock.monotonic_s()
    place = await robot.joints()
    since_s = clock.monotonic_s()
    warned = False
    while clock.monotonic_s() - begun_s <= PATIENCE_S * speed:
        await clock.sleep(_POLL_S * speed)
        # An answer that takes long, or is asked for again, says nothing about the time that it took.
        asked_s = clock.monotonic_s()
        here = await robot.joints()
        if not is_at(here, place, _SAME_PLACE):
            place, since_s = here, clock.monotonic_s()
            if not warned:
                warned = True
                await warn("the arm is moving and nothing of this run moves it: waiting until it stands")
        elif asked_s - since_s >= REST_S * speed:
            _require_no_program(robot, await robot.status())
            return place
    raise SafetyError(
        f"the arm was still moving after {PATIENCE_S:g} s, and not by this program: nothing was moved; stop it at "
        "the controller and find out what moves it, then start again"
    )


def _require_no_program(robot: Robot, status: RobotStatus) -> None:
    """Check that nothing runs on the controller but what the driver itself has running there."""
    if not status.running:
        return
    own = robot.own_program
    name = status.program.upper().partition(".")[0]
    # A driver whose program is started by the operator does not know its name, and a controller may report none.
    if own is None or (own and name and name != own):
        raise SafetyError(
            f"the program {name or '(without a name)'} runs on the controller and may move the arm at any time: "
            "nothing was moved; stop it at the controller, then start again"
        )
