"""What is looked at before anything moves: the controller's own limits, dimensions that nobody has confirmed."""

from collections.abc import Sequence

from catseye.app.engine.gate import JointLimits
from catseye.app.errors import LimitError
from catseye.drivers.roles.errors import ProtocolError, RefusedError
from catseye.drivers.roles.pose import Range
from catseye.drivers.roles.robot import Robot

_SAME = 0.01
"""Controllers tell their limits with two decimals, deg or mm."""


def beyond(limits: JointLimits, own: Sequence[Range]) -> list[str]:
    """Return which of the cell's ranges go beyond the controller's, and the remedy.

    Args:
        limits: ranges of the cell.
        own: the controller's lowest and highest of J1 … J4, deg or mm.
    """
    wanted = (
        ("limits_deg.j1", limits.j1_deg, own[0]),
        ("limits_deg.j2", limits.j2_deg, own[1]),
        ("j3_mm or j3_range_mm", limits.j3_mm, own[2]),
        ("limits_deg.j4", limits.j4_deg, own[3]),
    )
    return [
        f"robot.{key} = [{wish[0]:g}, {wish[1]:g}] goes beyond the controller's own limits {low:g}…{high:g} "
        "(parameter MEJAR), where it refuses to move: narrow it in the cell file"
        for key, wish, (low, high) in wanted
        # Written so that a limit that is not a number is no limit.
        if wish is not None and not (low - _SAME <= wish[0] and wish[1] <= high + _SAME)
    ]


async def require_within_controller(robot: Robot, limits: JointLimits) -> str:
    """Check a cell's ranges against those of the controller; return why that could not be done, empty when it could.

    Raises:
        LimitError: a range goes beyond the controller's.
        DeviceError: the link is lost.
    """
    try:
        own = await robot.joint_limits()
    except (RefusedError, ProtocolError) as error:
        return (
            f"the controller does not tell its joint limits (MEJAR), so the cell's were not compared: {error}"
        )
    if own is not None and (troubles := beyond(limits, own)):
        raise LimitError(f"{'; '.join(troubles)}: nothing was moved")
    return ""


def unconfirmed_text(dimensions: Sequence[str]) -> str:
    """Return what is said before a real arm moves whose bodies nobody has measured; empty when somebody has."""
    if not dimensions:
        return ""
    return (
        "the collision check works with dimensions that nobody has confirmed: "
        f"{'; '.join(dimensions)}; measure them and set confirmed = true in the cell file ([[body]], [workspace])"
    )
