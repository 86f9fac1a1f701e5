"""What the controller does with its arm: operating mode, motors, guard stop, and the execution of its program."""

from collections.abc import Callable
from typing import Final, Literal, get_args

from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.held_arm import HeldArm

Mode = Literal["AUTO", "MANR", "MANF"]
MODES: Final[tuple[Mode, ...]] = get_args(Mode)


class ArmControl(HeldArm):
    """The controller's hold on the arm; see `HeldArm`, whose override is the speed ratio and whose alarm a failure.

    Attributes:
        mode: of operation.
        guard_stop: a safeguard is open.
    """

    def __init__(self, bench: SerialBench, changed: Callable[[], None]) -> None:
        super().__init__(bench, changed)
        self.mode: Mode = "AUTO"
        self.guard_stop = False
        self._was_pressed = False

    @property
    def state(self) -> str:
        """What rw/panel/ctrlstate says."""
        if self.alarm:
            return "sysfail"
        if self.emergency_stop:
            return "emergencystop"
        if self._was_pressed:
            return "emergencystopreset"
        # In manual mode the enabling device of the pendant is a safeguard, and nobody holds it.
        if self.guard_stop or self.mode != "AUTO":
            return "guardstop"
        return "motoron" if self.servo_on else "motoroff"

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit; the button on the panel confirms afterwards."""
        self._was_pressed |= on
        super().set_emergency_stop(on=on)

    def lose_power(self) -> None:
        """Let the brakes stop the arm; what stays is what hands have pressed, opened or turned, and the goal."""
        super().lose_power()
        self._was_pressed = self.emergency_stop

    def open_guard(self) -> None:
        """Open a safeguard: program and motors stop."""
        self.guard_stop = True
        self.switch_servo_off()

    def confirm(self) -> None:
        """Close safeguards, confirm what was pressed, and let the system recover from a failure."""
        self.guard_stop = self._was_pressed = False
        self.alarm = 0

    def set_mode(self, mode: Mode) -> None:
        """Turn the mode switch: program and motors stop."""
        if mode != self.mode:
            self.switch_servo_off()
        self.mode = mode

    def switch_servo_on(self) -> None:
        """Power the motors.

        Raises:
            EmulatorError: manual mode, a safeguard, an emergency stop or a failure keeps them off.
        """
        if self.state not in {"motoroff", "motoron"}:
            raise EmulatorError(f"the motors stay off: the controller is in {self.state}")
        super().switch_servo_on()
