"""What is said where nobody states from which side the joints of an arm with backlash come."""

from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.output import warn

if TYPE_CHECKING:
    from catseye.app.results.serial_arm.identified_arm import IdentifiedArm


def warn_of_sides(arm: "IdentifiedArm", poses: Path, *, sided: bool) -> None:
    """Warn that joints are taken to come from below, where that makes a difference.

    Args:
        sided: the file says from which side each joint comes.
    """
    if arm.reverses and not sided:
        warn(
            f"the arm has backlash, and {poses} does not say from which side its joints come: what is written holds "
            "for approaches from below; state direction1, direction2, … (1 from below, -1 from above) for others"
        )
