"""The smartPAD and the mode switch: what an operator's hands do at a KR C4.

The sheet says nothing of it; what is modelled follows public operating instructions of the System Software, from
memory. What of it may differ is an option of the emulator.
"""

import re
from dataclasses import dataclass
from typing import Final

from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka.arm_control import MODES, SOFTWARE_LIMIT, ArmControl
from catseye.simulators.kuka.program import CatsKuka

_JOG_KEY: Final = re.compile(r"A([1-6])([+-])")


@dataclass(frozen=True)
class PanelOptions:
    """What may differ between controllers.

    Attributes:
        limit_needs_confirm: a point beyond the software limits is a message that has to be confirmed; else it goes
            when the program is reset.
        bco_halts: behind block coincidence the program halts in T1, T2 and AUT, and start is to be pressed again.
        jog_deg: how far an axis turns at one press of a jog key (incremental jogging).
    """

    limit_needs_confirm: bool = True
    bco_halts: bool = True
    jog_deg: float = 1.0


class Panel:
    """Keys of the smartPAD, and the mode switch.

    Args:
        control: of the arm.
        program: that is selected.

    Attributes:
        options: how this controller behaves.
    """

    def __init__(self, control: ArmControl, program: CatsKuka) -> None:
        self.options = PanelOptions()
        self._control = control
        self._program = program

    def press(self, key: str) -> None:
        """Press a key, or turn the mode switch.

        Raises:
            EmulatorError: it has no effect now.
        """
        match key:
            case "start":
                self._start()
            case "stop":
                self._control.hold()
            case "reset":
                self._reset()
            case "confirm":
                self._control.alarm = 0
            case "drives":
                self._control.switch_servo_on()
            case _ if key in MODES:
                self._control.set_mode(key)
            case _ if jogged := _JOG_KEY.fullmatch(key):
                self._jog(int(jogged[1]), 1.0 if jogged[2] == "+" else -1.0)
            case _:
                raise EmulatorError(f"the panel of a KR C4 has no key {key!r}")

    def _start(self) -> None:
        if not self._program.selected:
            raise EmulatorError("the program does not start: none is selected; press reset before")
        if not self._control.ready:
            raise EmulatorError("the program does not start: drives off, emergency stop, or a message")
        # In EX nobody stands beside it to press start once more.
        self._program.start(halts=self.options.bco_halts and self._control.mode != "EX")

    def _reset(self) -> None:
        """Select the first line of the program."""
        if self._program.running:
            raise EmulatorError("the program is not reset: it runs; press stop before")
        self._program.reset()
        if self._control.alarm == SOFTWARE_LIMIT and not self.options.limit_needs_confirm:
            self._control.alarm = 0

    def _jog(self, number: int, sense: float) -> None:
        if self._program.running:
            raise EmulatorError(f"A{number} is not jogged: the program runs; press stop before")
        self._control.jog(number, sense * self.options.jog_deg)
