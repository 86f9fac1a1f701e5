"""What is looked at before anything moves: the controller's own limits, dimensions that nobody has confirmed."""

from collections.abc import Sequence

from catseye.app.errors import LimitError
from catseye.drivers.roles.errors import ProtocolError, RefusedError
from catseye.drivers.roles.pose import Range
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.bench import Arm

_SAME = 0.01
"""Controllers report their limits with two decimals, deg or mm."""


def beyond(arm: Arm, own: Sequence[Range]) -> list[str]:
    """Return which of the cell's ranges go beyond the controller's, and the remedy.

    Args:
        own: the controller's lowest and highest of each axis, deg or mm.
    """
    return [
        f"robot.{key} = [{axis.low:g}, {axis.high:g}] goes beyond the controller's own limits {low:g}…{high:g} "
        "(parameter MEJAR), where it refuses to move: narrow it in the cell file"
        for key, axis, (low, high) in zip(arm.range_keys, arm.axes, own, strict=True)
        # Written so that a limit that is not a number is no limit.
        if not (low - _SAME <= axis.low and axis.high <= high + _SAME)
    ]


async def require_within_controller(robot: Robot, arm: Arm) -> str:
    """Check a cell's ranges against those of the controller; return why that could not be done, empty when it could.

    Raises:
        LimitError: a range goes beyond the controller's.
        DeviceError: the link is lost.
    """
    try:
        own = await robot.joint_limits()
    except (RefusedError, ProtocolError) as error:
        return f"the controller does not report its joint limits (MEJAR), so the cell's were not compared: {error}"
    if own is not None and (troubles := beyond(arm, own)):
        raise LimitError(f"{'; '.join(troubles)}: nothing was moved")
    return ""


def unconfirmed_text(dimensions: Sequence[str]) -> str:
    """Return what is said before a real arm moves whose bodies nobody has measured; empty when somebody has."""
    if not dimensions:
        return ""
    return (
        f"the collision check uses unconfirmed dimensions: {'; '.join(dimensions)}; measure them and set confirmed "
        "= true in the cell file ([[body]], [workspace])"
    )
