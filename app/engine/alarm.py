"""Alarms of a controller: what forbids a run, and how one goes that somebody has read."""

from typing import Final

from catseye.app.errors import SafetyError
from catseye.drivers.roles.robot import Robot, RobotStatus

RESET: Final = "! on Bench (F2) of catseye tui, or catseye reset-alarm CELL"
"""How an alarm is reset once its cause is removed."""


def require_no_alarm(status: RobotStatus, how: str = "") -> None:
    """Check that a controller is in no alarm.

    Args:
        how: it is reset, if it can be.

    Raises:
        SafetyError: it is in one; the text says what it means.
    """
    if status.alarm_number:
        then = f"; then reset it: {how}" if how else ""
        raise SafetyError(f"the controller is in alarm {status.alarm_number}: {status.alarm_text}{then}")


async def reset_read_alarm(robot: Robot, number: int, text: str) -> None:
    """Reset the alarm that somebody has read, and no other one. Nothing moves; the drives stay as they are.

    Args:
        number: of the alarm that was read.
        text: that was read.

    Raises:
        SafetyError: there is none, another one, or still one; the arm moves.
        DeviceError: the controller does not reset it.
    """
    status = await robot.status()
    if not status.alarm_number:
        raise SafetyError("the alarm is gone: nothing was reset")
    if (status.alarm_number, status.alarm_text) != (number, text):
        raise SafetyError(
            f"the controller is in another alarm by now, {status.alarm_number}: {status.alarm_text}; nothing was "
            "reset: read this one first"
        )
    if status.running:
        raise SafetyError("the arm moves, or a program runs: nothing was reset; stop that first")
    await robot.reset_alarm()
    require_no_alarm(await robot.status())
