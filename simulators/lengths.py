"""How emulated interferometers show lengths."""

from dataclasses import dataclass
from typing import Literal

from catseye.simulators.emulator import DeviceOptions
from catseye.simulators.world.counter import Reading


@dataclass(frozen=True)
class Lengths:
    """How an instrument shows lengths.

    Attributes:
        compensated: it corrects for the air by itself; otherwise lengths are vacuum wavelengths, counted.
        sign: -1 when its lengths fall while the beam grows longer.
    """

    compensated: bool = False
    sign: int = 1

    def shown_mm(self, reading: Reading) -> float:
        """Return the length that the instrument shows, mm."""
        return self.sign * (reading.displacement_mm if self.compensated else reading.vacuum_mm)


class LengthOptions(DeviceOptions):
    """Options of emulated interferometers.

    Attributes:
        compensated: who corrects for the air; "instrument" makes the emulator do it.
        sign: see `Lengths`.
    """

    compensated: Literal["none", "instrument", "auto"] = "none"
    sign: Literal[1, -1] = 1

    @property
    def lengths(self) -> Lengths:
        """How the instrument shows lengths."""
        return Lengths(self.compensated == "instrument", self.sign)
