"""What the controller does with its arm: the mode switch, the software limit switches, and jogging."""

from collections.abc import Callable
from typing import Final, Literal, get_args

from catseye.simulators.config import Joints, SerialArm
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.held_arm import HeldArm

Mode = Literal["T1", "T2", "AUT", "EX"]
MODES: Final[tuple[Mode, ...]] = get_args(Mode)

SOFTWARE_LIMIT: Final = 1
"""The controller's message of a goal beyond the software limit switches; the sheet has no numbers of messages."""

_MANUAL: Final = ("T1", "T2")
_JOG_PERCENT: Final = 10.0


class ArmControl(HeldArm):
    """The controller's hold on the arm; see `HeldArm`, whose override is $OV_PRO.

    Args:
        bench: on which the arm stands.
        arm: with the software limits of its axes.
        changed: called when a motion ends at another moment than it would have.

    Attributes:
        mode: of operation.
    """

    def __init__(self, bench: SerialBench, arm: SerialArm, changed: Callable[[], None]) -> None:
        super().__init__(bench, changed)
        self.mode: Mode = "EX"
        self._axes = arm.joints

    def set_mode(self, mode: Mode) -> None:
        """Turn the mode switch: the program stops."""
        if mode != self.mode:
            self.hold()
        self.mode = mode

    def within_limits(self, joints: Joints) -> bool:
        """Return whether a pose, deg, lies within the software limit switches."""
        return all(axis.low <= value <= axis.high for value, axis in zip(joints, self._axes, strict=True))

    def refuse_beyond_limits(self) -> None:
        """Show the message of a point that cannot be reached: the program stands, and nothing has moved."""
        self.raise_alarm(SOFTWARE_LIMIT)

    def jog(self, number: int, way_deg: float) -> None:
        """Turn one axis by hand, as far as its software limit; one that stands beyond it is only turned back.

        Args:
            number: of the axis, from 1.
            way_deg: how far.

        Raises:
            EmulatorError: not in T1 or T2, the drives are off, the arm moves, or the axis stands at its limit.
        """
        if self.mode not in _MANUAL or not self.servo_on or self.bench.moving:
            raise EmulatorError(
                f"A{number} is not jogged: turn the mode switch to T1 or T2, power the drives, let the arm stand"
            )
        axis, here = self._axes[number - 1], self.bench.joints
        at_deg = here[number - 1]
        goal_deg = min(max(at_deg + way_deg, min(axis.low, at_deg)), max(axis.high, at_deg))
        if goal_deg == at_deg:
            raise EmulatorError(f"A{number} is not jogged: it stands at its software limit, {at_deg:g}°")
        self.bench.move_to((*here[: number - 1], goal_deg, *here[number:]), _JOG_PERCENT)
        self._changed()
