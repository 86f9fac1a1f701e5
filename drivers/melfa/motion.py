"""Parts of a joint motion: its command, the comparison of reported joints with it, waiting for standstill."""

import asyncio
from collections.abc import Awaitable, Callable

from drivers.clock import Clock
from drivers.errors import (
    AlarmError,
    DeviceError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    ProtocolError,
    RefusedError,
)
from drivers.melfa.session import Session
from drivers.melfa.settings import MelfaSettings
from drivers.readings import Joints

VARIABLE = "JCATSEYE"
"""Joint variable that carries the target in the controller."""

JOINT_NAMES = ("J1", "J2", "J3", "J4")
LOOK_WHY = "look for a collision, a stop by another source or an alarm before moving again"

STILL_POLLS = 3
"""Equal positions in a row that count as standstill."""

_JOINT_UNITS = ("deg", "deg", "mm", "deg")

_START_TIME_S = 0.5
_NETWORK_POLL_S = 0.02
_POLL_BYTES = 130
_FEWEST_POLLS = 4


def assignment(target: Joints) -> str:
    """Return the statement that sets the variable: four decimals, never a negative zero (sheet 4.2)."""
    values = ",".join(f"{round(value, 4) + 0.0:.4f}" for value in target)
    return f"{VARIABLE}=({values})"


def off_target(reached: Joints, target: Joints, settings: MelfaSettings) -> str:
    """Return the joints that are reported off the target, in words; empty when all are there."""
    limits = {"deg": settings.tolerance_deg, "mm": settings.tolerance_mm}
    return ", ".join(
        f"{name} is at {at:.2f} {unit} instead of {to:.4f} {unit}"
        for name, unit, at, to in zip(JOINT_NAMES, _JOINT_UNITS, reached, target, strict=True)
        if abs(at - to) > limits[unit]
    )


def unstarted_polls(byte_s: float) -> int:
    """Return how many equal positions in a row say that a motion which was started has ended or never began.

    They span half a second: 25 polls over a network, fewer on a serial line, where the bytes of one poll take longer.

    Args:
        byte_s: time of one byte on a serial line, real s; 0 on a network.
    """
    return max(_FEWEST_POLLS, round(_START_TIME_S / (_NETWORK_POLL_S + _POLL_BYTES * byte_s)))


async def standstill(
    session: Session,
    clock: Clock,
    settings: MelfaSettings,
    *,
    timeout_s: float,
    still_polls: int,
    target: Joints | None = None,
) -> Joints:
    """Poll until nothing runs and the joints stay the same, or stand at the target.

    The run bit alone is not enough: no source says whether it covers statements that are executed directly.

    Args:
        session: where to ask.
        clock: time of the pause between two polls.
        settings: of the driver.
        timeout_s: for all polls together, real s.
        still_polls: equal positions in a row that count as standstill.
        target: of the motion, if one was started.

    Returns:
        The joints at standstill.

    Raises:
        LinkTimeoutError: still moving.
        ProtocolError: a question was refused, which a line that garbles bytes does.
        DeviceError: the controller does not answer as it should.
    """
    last: Joints | None = None
    equal = 0
    try:
        async with asyncio.timeout(timeout_s):
            while True:
                running = (await session.state()).running
                joints = await session.joints()
                if target and not running and not off_target(joints, target, settings):
                    return joints
                equal = equal + 1 if joints == last and not running else 1
                if equal >= still_polls:
                    return joints
                last = joints
                await clock.sleep(settings.poll_s)
    except AlarmError:
        raise
    except RefusedError as exc:
        raise ProtocolError(f"{session.where}: a question was refused while the arm may move: {exc}") from exc
    except TimeoutError:
        raise LinkTimeoutError(
            f"{session.where}: the robot does not stand still after {timeout_s:g} s, last joints {last}: "
            "check what moves it"
        ) from None


async def account_for(
    session: Session,
    clock: Clock,
    settings: MelfaSettings,
    target: Joints,
    lost: DeviceError,
    stop: Callable[[], Awaitable[None]],
) -> None:
    """Ask where the robot is after the answer to a motion was lost; go on only if it stands at the target.

    Args:
        session: where to ask.
        clock: time of the pause between two polls.
        settings: of the driver.
        target: of the motion.
        lost: how the answer was lost.
        stop: stops the robot.

    Raises:
        AlarmError: an alarm is the reason.
        NotArrivedError: the robot stands somewhere else; it was told to stop.
        LinkError: the controller does not tell; the robot was told to stop.
    """
    try:
        status, joints = await session.status(), await session.joints()
        off = off_target(joints, target, settings)
        # A program that waits for the next way counts as running too: then only the joints tell.
        if not off and (not status.running or await _rests(session, clock, settings)):
            return
    except DeviceError as exc:
        await stop()
        raise LinkError(
            f"{session.where}: the answer to the motion is lost ({lost}) and the controller does not tell "
            f"where the robot is ({exc}): the robot was told to stop; {LOOK_WHY}"
        ) from lost
    await stop()
    if status.alarm_number:
        raise AlarmError(f"{session.where}: {status.alarm_text}", status.alarm_number) from lost
    was = "was still moving" if status.running else f"stands elsewhere ({off})"
    slow = "raise move_timeout_s or the override if the motion is only slow; "
    raise NotArrivedError(
        f"{session.where}: the answer to the motion is lost ({lost}); the robot {was} and was told to stop: "
        f"{slow if isinstance(lost, LinkTimeoutError) else ''}{LOOK_WHY}"
    ) from lost


async def _rests(session: Session, clock: Clock, settings: MelfaSettings) -> bool:
    """Return whether the joints stay the same over some polls."""
    first = await session.joints()
    for _ in range(STILL_POLLS - 1):
        await clock.sleep(settings.poll_s)
        if await session.joints() != first:
            return False
    return True
