"""What the controller does with its arm, and the mode switch."""

from collections.abc import Callable
from typing import Final, Literal, get_args

from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.held_arm import HeldArm

Mode = Literal["T1", "T2", "AUT", "EX"]
MODES: Final[tuple[Mode, ...]] = get_args(Mode)


class ArmControl(HeldArm):
    """The controller's hold on the arm; see `HeldArm`, whose override is $OV_PRO.

    Attributes:
        mode: of operation.
    """

    def __init__(self, bench: SerialBench, changed: Callable[[], None]) -> None:
        super().__init__(bench, changed)
        self.mode: Mode = "EX"

    def set_mode(self, mode: Mode) -> None:
        """Turn the mode switch: the program stops."""
        if mode != self.mode:
            self.hold()
        self.mode = mode
