"""What a controller does with a serial arm: drives, override, and one motion that may be held on its way."""

from collections.abc import Callable

from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.serial.bench import SerialBench

Begin = Callable[[float], None]
"""Starts the way to a goal from where the arm stands, at a share of the speeds, 0...1."""


class HeldArm:
    """A controller's hold on the arm.

    Args:
        bench: on which the arm stands.
        changed: called when a motion ends at another moment than it would have.

    Attributes:
        override_percent: of the programmed speed.
        servo_on: the drives hold the arm.
        alarm: number of the message that keeps the program from running, 0 for none.
        emergency_stop: the circuit is open.
        on_arrival: called when a motion has reached its goal.
        on_hold: called when something other than the program stops the arm: its program stands then.
    """

    def __init__(self, bench: SerialBench, changed: Callable[[], None]) -> None:
        self.bench = bench
        self.override_percent = 100
        self.servo_on = True
        self.alarm = 0
        self.emergency_stop = False
        self.on_arrival: Callable[[], None] = lambda: None
        self.on_hold: Callable[[], None] = lambda: None
        self._changed = changed
        self._begin: Begin | None = None
        self._held = False
        self._interrupted = False

    @property
    def ready(self) -> bool:
        """A program may run: drives on, nothing pressed, no message."""
        return self.servo_on and not self.emergency_stop and not self.alarm

    def go(self, begin: Begin) -> None:
        """Move to a goal; at an override of 0 the arm waits until it is raised."""
        self._begin = begin
        self._held = False
        self._interrupted = True
        self._continue()

    def brake(self) -> float:
        """Give the goal up and stop; return the bench time of the standstill, s."""
        self._begin = None
        self.bench.stop()
        self._changed()
        return max(self.bench.standstill_s, self.bench.time_s)

    def hold(self) -> None:
        """Stop on the way; the goal is kept until the program goes on."""
        self._held = True
        self._interrupt()
        self.on_hold()

    def release(self) -> None:
        """Go on to the goal, once the arm stands."""
        self._held = False
        self._continue()

    def set_override(self, percent: int) -> None:
        """Take another override: the way that is left is driven with it."""
        if percent == self.override_percent:
            return
        self.override_percent = percent
        self._interrupt()
        self._continue()

    def raise_alarm(self, number: int) -> None:
        """Show a message that stops the program."""
        self.alarm = number
        self.hold()

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit; opening it takes the power off."""
        self.emergency_stop = on
        if on:
            self.switch_servo_off()

    def switch_servo_off(self) -> None:
        """Stop the arm and take the power off."""
        self.hold()
        self.servo_on = False

    def lose_power(self) -> None:
        """Let the brakes stop the arm; messages and the override are forgotten, the goal is not."""
        self.switch_servo_off()
        if self._begin is None:
            # Hands have jogged it.
            self.bench.stop()
        self.alarm = 0
        self.override_percent = 100

    def switch_servo_on(self) -> None:
        """Power the drives.

        Raises:
            EmulatorError: the emergency stop circuit is open.
        """
        if self.emergency_stop:
            raise EmulatorError("the drives stay off: the emergency stop circuit is open")
        self.servo_on = True

    def _interrupt(self) -> None:
        if self._begin is None:
            return
        self._interrupted = True
        self.bench.stop()
        self._plan_look()

    def _continue(self) -> None:
        """Start towards the goal if the arm stands and may move; otherwise a look at its standstill does."""
        may_move = not self._held and self.servo_on and self.override_percent > 0
        if self._begin is None or not may_move or self.bench.moving:
            return
        self._interrupted = False
        self._begin(self.override_percent / 100.0)
        self._plan_look()

    def _plan_look(self) -> None:
        self.bench.call_at(self.bench.standstill_s, self._look)
        self._changed()

    def _look(self) -> None:
        """Look at an arm that may have come to rest: at its goal, or where it was interrupted."""
        if self.bench.moving or self._begin is None:
            return
        if self._interrupted:
            self._continue()
        else:
            self._begin = None
            self.on_arrival()
