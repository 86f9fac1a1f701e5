"""Where a motion that is over has ended: how far a controller reads an arm back beside its command."""

from collections.abc import Sequence

from catseye.drivers.roles.errors import NotArrivedError
from catseye.drivers.roles.pose import Pose, is_at


def require_arrived(
    where: str, names: Sequence[str], reached: Pose, target: Pose, tolerance_deg: float
) -> None:
    """Check that the arm stands where its motion was to end.

    Args:
        where: the connection, for people.
        names: of the joints.
        reached: joints that the controller reads back, deg.
        target: joints of the motion, deg.
        tolerance_deg: the driver's setting of that name.

    Raises:
        NotArrivedError: it stands somewhere else.
    """
    if is_at(reached, target, tolerance_deg):
        return
    name, at, to = max(zip(names, reached, target, strict=True), key=lambda each: abs(each[1] - each[2]))
    raise NotArrivedError(
        f"{where}: the motion is over, but {name} is read back at {at:.3f}° instead of {to:.3f}°, more than "
        f"tolerance_deg = {tolerance_deg:g} off: check whether something is in the arm's way; where nothing is, its "
        "controller reads back other joints than it is sent to: write a larger tolerance_deg into [robot.settings] "
        "of the cell file"
    )
