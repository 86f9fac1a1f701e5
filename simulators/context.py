"""What all emulated devices of one bench share."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from catseye.simulators.config import EmulationConfig
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.modbus.remote_io import Door, RemoteIo
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.bench import Bench, Instrument
from catseye.simulators.world.journal import Journal
from catseye.simulators.world.timekeeper import TimeKeeper


@dataclass(frozen=True)
class World:
    """One emulated bench, as the makers of sessions see it.

    Attributes:
        config: of the emulation.
        bench: the physical truth.
        truth: the true arm in the result format.
        controller: the robot controller; all its endpoints lead to it.
        keeper: bench time.
        journal: what happened.
        probe: what the air sensors measure.
        door: of the cell.
        blocks: remote inputs and outputs by the name of the device.
        instruments: length counters by the name of the device.
    """

    config: EmulationConfig
    bench: Bench
    truth: Mapping[str, object]
    controller: Controller
    keeper: TimeKeeper
    journal: Journal
    probe: AirProbe
    door: Door = field(default_factory=Door)
    blocks: dict[str, RemoteIo] = field(default_factory=dict)
    instruments: dict[str, Instrument] = field(default_factory=dict)

    def instrument(self, device: str) -> Instrument:
        """Return the length counter of a device; all its endpoints and clients lead to the same one."""
        if device not in self.instruments:
            self.instruments[device] = self.bench.new_instrument()
        return self.instruments[device]
