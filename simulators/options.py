"""Options of emulated devices, checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.counter import Reading


def number(device: EmulatedDevice, key: str, default: float) -> float:
    """Return an option that is a number.

    Raises:
        EmulatorError: it is none.
    """
    value = device.options.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise EmulatorError(f"{device.name}: option {key} has to be a number, not {value!r}")
    return value


def whole(device: EmulatedDevice, key: str, default: int, lowest: int, highest: int) -> int:
    """Return an option that is a whole number within limits.

    Raises:
        EmulatorError: it is none.
    """
    value = number(device, key, default)
    if not isinstance(value, int) or not lowest <= value <= highest:
        raise EmulatorError(
            f"{device.name}: option {key} has to be a whole number from {lowest} to {highest}, not {value!r}"
        )
    return value


def flag(device: EmulatedDevice, key: str) -> bool:
    """Return an option that is true or false; false is the default.

    Raises:
        EmulatorError: it is neither.
    """
    value = device.options.get(key, False)
    if not isinstance(value, bool):
        raise EmulatorError(f"{device.name}: option {key} has to be true or false, not {value!r}")
    return value


def choice(device: EmulatedDevice, key: str, choices: Sequence[str]) -> str:
    """Return an option that is one of some words; the first is the default.

    Raises:
        EmulatorError: it is none of them.
    """
    value = device.options.get(key, choices[0])
    if value not in choices:
        raise EmulatorError(
            f"{device.name}: option {key} has to be one of {', '.join(choices)}, not {value!r}"
        )
    return str(value)


@dataclass(frozen=True)
class LengthOptions:
    """How an emulated interferometer tells lengths.

    Attributes:
        compensated: it corrects for the air by itself; otherwise lengths are vacuum wavelengths, counted.
        sign: -1 when its lengths fall while the beam grows longer.
    """

    compensated: bool = False
    sign: int = 1

    @classmethod
    def of(cls, device: EmulatedDevice) -> Self:
        """Read the options `compensated` and `sign`.

        Raises:
            EmulatorError: one of them is wrong.
        """
        sign = number(device, "sign", 1)
        if sign not in {1, -1}:
            raise EmulatorError(f"{device.name}: option sign has to be 1 or -1, not {sign!r}")
        compensated = choice(device, "compensated", ("none", "instrument", "auto"))
        return cls(compensated == "instrument", int(sign))

    def shown_mm(self, reading: Reading) -> float:
        """Return the length that the instrument shows, mm."""
        return self.sign * (reading.displacement_mm if self.compensated else reading.vacuum_mm)
