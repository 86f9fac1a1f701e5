"""Which joints an arm was identified with, and what it is then good for."""

from typing import Literal

from catseye.calibration.core.errors import ArgumentError

JointSource = Literal["commanded", "read back"]


def require_commanded(joints: object) -> None:
    """Refuse to make commands of an arm that was identified with the joints that its controller read back.

    By how much the arm misses its commands is then in no parameter: it would stand elsewhere than is computed.

    Args:
        joints: of the result, as its file has it; a file without them is of commanded ones.

    Raises:
        ArgumentError: they were read back.
    """
    if joints == "read back":
        raise ArgumentError(
            "the result was identified with the joints that the controller read back, and does not know by how much "
            "the arm misses its commands: calibrate again from the table without its columns q1_read_deg … "
            "(catseye export writes that of a run)"
        )
