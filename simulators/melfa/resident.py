"""Programs of the controller whose behaviour is emulated without an interpreter: data link and real-time control.

Such a program runs from the start, as if an operator had started it, in a slot of its own beside the selected
program. A STOP, an alarm or the key at TEACH halts it. RUN lets it go on; RSTPRG and SLOTINIT take it back to its
top, from where RUN or the next client's first word starts it again, which stands for the operator's start.
"""

from collections.abc import Callable
from enum import Enum

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal


class Stage(Enum):
    """Where a program stands."""

    AT_TOP = "at its top"
    RUNNING = "running"
    HALTED = "halted"


class Resident:
    """One such program.

    Args:
        name: by which RUN starts it.
        require_start: raises a refusal while no program may start.
        changed: called when it goes on or begins anew: those who wait for it look again.
    """

    def __init__(self, name: str, require_start: Callable[[], None], changed: Callable[[], None]) -> None:
        self.name = name
        self._require_start = require_start
        self.stage = Stage.RUNNING
        self._changed = changed

    @property
    def running(self) -> bool:
        """It carries out its statements."""
        return self.stage is Stage.RUNNING

    def start(self) -> None:
        """Begin at the top, or go on where it was halted."""
        if self.stage is Stage.HALTED:
            self.go_on()
        self.stage = Stage.RUNNING
        self._changed()

    def wake(self) -> None:
        """Take a client's first word as the operator's start, if the program waits at its top and may start."""
        if self.stage is not Stage.AT_TOP:
            return
        try:
            self._require_start()
        except Refusal:
            return
        self.start()

    def halt(self, number: int) -> None:
        """Stop where it is; switching the servo off alone stops nothing unless the program needs the arm.

        Args:
            number: why, an error number.
        """
        if self.running and (number != alarms.SERVO_IS_OFF or self.busy):
            self.stage = Stage.HALTED
            self.halted()

    def reset(self) -> None:
        """Go back to the top, without starting."""
        self.stage = Stage.AT_TOP
        self.begin()
        self._changed()

    @property
    def busy(self) -> bool:
        """It has the arm in its hands."""
        return False

    def begin(self) -> None:
        """Forget everything: it will start at its top."""

    def go_on(self) -> None:
        """Take up what a halt interrupted."""

    def halted(self) -> None:
        """Let go of the arm, which is being stopped."""
