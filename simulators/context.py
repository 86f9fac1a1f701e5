"""What all emulators of one bench share."""

import hashlib
import json
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Protocol

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.air_probe import AirSensors
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.door import Door
from catseye.simulators.world.instrument import Instrument
from catseye.simulators.world.journal import Journal
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.tracker import LaserTracker
from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.timekeeper import TimeKeeper


class RobotController(Protocol):
    """What the control port shows and does of a robot controller, whatever its make."""

    @property
    def servo_on(self) -> bool:
        """The drives hold the arm."""
        ...

    @property
    def alarm(self) -> int:
        """The active alarm, 0 for none."""
        ...

    def raise_alarm(self, number: int) -> None:
        """Let an alarm occur."""
        ...

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit."""
        ...

    def set_teach_mode(self, *, on: bool) -> None:
        """Turn the key."""
        ...

    def switch_servo_off(self) -> None:
        """Stop the arm and take the power off."""
        ...

    def press(self, key: str) -> None:
        """Press or turn something on the operator panel; see `PanelKey` of the control port.

        Raises:
            EmulatorError: this controller's panel has no such key.
        """
        ...

    def lose_power(self) -> None:
        """Stop the arm, which its brakes hold then, and forget whatever is not kept without power."""
        ...

    def clear_faults(self) -> None:
        """Close the emergency stop circuit, turn the key back and reset the alarm."""
        ...


@dataclass(frozen=True)
class EmulationContext:
    """One emulated bench, as its emulators see it.

    Attributes:
        bench: the physical truth, whatever arm stands on it.
        truth: the true arm in the result format.
        controller: the robot controller; all its endpoints lead to it.
        keeper: bench time.
        journal: what happened.
        air: sensors of the air.
        laser_tracker: that stands beside the arm.
        coils: outputs of remote blocks by the name of the device.
        instruments: length counters by the name of the device.
        power_back_s: bench time at which the power of a device comes back, or came, by the name of the device.
        started: tells this start of the bench from any other.
    """

    config: EmulationConfig
    bench: TimedBench
    truth: Mapping[str, object]
    controller: RobotController
    keeper: TimeKeeper
    journal: Journal
    air: AirSensors
    laser_tracker: LaserTracker
    door: Door = field(default_factory=Door)
    coils: dict[str, list[bool]] = field(default_factory=dict)
    instruments: dict[str, Instrument] = field(default_factory=dict)
    power_back_s: dict[str, float] = field(default_factory=dict)
    started: str = field(default_factory=partial(secrets.token_hex, 8))

    @cached_property
    def truth_digest(self) -> str:
        """A few digits of the true arm's SHA-256."""
        return hashlib.sha256(json.dumps(self.truth, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def beam_bench(self) -> Bench:
        """The bench of an arm that carries a beam.

        Raises:
            EmulatorError: the arm of this bench carries none.
        """
        if not isinstance(self.bench, Bench):
            raise EmulatorError("the arm of this bench carries no beam")
        return self.bench

    @property
    def serial_bench(self) -> SerialBench:
        """The bench of a serial arm.

        Raises:
            EmulatorError: there stands another one.
        """
        if not isinstance(self.bench, SerialBench):
            raise EmulatorError("on this bench stands no serial arm")
        return self.bench

    def instrument(self, device: str) -> Instrument:
        """Return the length counter of a device; all its endpoints and clients lead to the same one."""
        if device not in self.instruments:
            self.instruments[device] = Instrument(self.bench)
        return self.instruments[device]
