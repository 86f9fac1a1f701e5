"""Where air sensors keep their values (sheet of the air sensors, sections 1a and 2). Pure."""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.roles.errors import ProfileError, ProtocolError

Kind = Literal["float32", "int16", "uint16", "int32"]
WordOrder = Literal["big", "little"]
Name = Literal["temperature", "pressure", "humidity"]

_FORMATS: dict[Kind, str] = {"float32": ">f", "int16": ">h", "uint16": ">H", "int32": ">i"}
_MISSING_INT16 = 0x8000
_TINY = 1e-30

LIMITS: dict[Name, tuple[float, float, str]] = {
    "temperature": (-40.0, 60.0, "°C"),
    "pressure": (500.0, 1200.0, "hPa"),
    "humidity": (0.0, 100.0, "%RH"),
}
"""What air around a robot can be: lowest, highest, unit."""


@dataclass(frozen=True)
class Quantity:
    """One value.

    Attributes:
        address: register as the documents number it; `RegisterMap.address_base` is taken off on the wire.
        kind: representation.
        scale: factor from the number to °C, hPa or %RH.
        offset: added after scaling, in °C, hPa or %RH.
        invalid: numbers that mean "no value", before scaling; NaN always does.
    """

    address: int
    kind: Kind = "float32"
    scale: float = 1.0
    offset: float = 0.0
    invalid: tuple[float, ...] = ()

    @property
    def registers(self) -> int:
        """How many registers it takes."""
        return struct.calcsize(_FORMATS[self.kind]) // 2


@dataclass(frozen=True)
class RegisterMap:
    """The values of one kind of sensor; a quantity that it does not give is None.

    Attributes:
        title: what to call the sensor.
        temperature: °C.
        pressure: hPa.
        humidity: %RH.
        function: 3 reads holding, 4 input registers.
        word_order: `little` when the less significant word comes first (CDAB).
        address_base: number that the documents give to the first register.
    """

    title: str
    temperature: Quantity | None = None
    pressure: Quantity | None = None
    humidity: Quantity | None = None
    function: Literal[3, 4] = 3
    word_order: WordOrder = "big"
    address_base: Literal[0, 1] = 0

    def quantities(self) -> dict[Name, Quantity]:
        """Return the quantities that the sensor gives."""
        named: dict[Name, Quantity | None] = {
            "temperature": self.temperature,
            "pressure": self.pressure,
            "humidity": self.humidity,
        }
        return {name: quantity for name, quantity in named.items() if quantity}

    def wire_address(self, quantity: Quantity) -> int:
        """Return the number on the wire: registers count from 0 there."""
        return quantity.address - self.address_base

    def label(self, name: Name) -> str:
        """Return a quantity with its register, for texts."""
        quantity = self.quantities()[name]
        wire = self.wire_address(quantity)
        return f"{name} ({quantity.kind} at register 0x{quantity.address:04X}, 0x{wire:04X} on the wire)"


VAISALA = RegisterMap(
    "Vaisala sensor",
    temperature=Quantity(0x0002),
    humidity=Quantity(0x0000),
    word_order="little",
)
COMET_WEB = RegisterMap(
    "Comet Web Sensor",
    temperature=Quantity(0x0031, "int16", 0.1),
    humidity=Quantity(0x0032, "int16", 0.1),
    pressure=Quantity(0x0034, "int16", 0.1),
)
# The same documents for RS-485 transmit address 0x31 as 0x30.
COMET_RTU = replace(COMET_WEB, title="Comet transmitter (RTU)", address_base=1)
GENERIC = RegisterMap("Modbus air sensor")

VAISALA_PRESSURE_NOTE = (
    "no pressure is read: the public documents do not give the pressure register of the PTU300. Set "
    "pressure_address to the address in its manual (0x002C, register 45 of the DPT145, is a guess from the family)"
)


class Point(DeviceSettings):
    """Where one quantity is: a line of `[[environment.settings.points]]`.

    Attributes:
        name: temperature, pressure or humidity.
        address: register, as the documents number it.
        type: representation.
        scale: factor to °C, hPa or %RH.
        offset: added after scaling.
        invalid: numbers, before scaling, that mean "no value"; NaN always does, 0x8000 does for int16.
    """

    name: Name
    address: int = Field(ge=0, le=0xFFFF)
    type: Kind = "float32"
    scale: float = Field(default=1.0, allow_inf_nan=False)
    offset: float = Field(default=0.0, allow_inf_nan=False)
    invalid: list[float] = Field(default=[])

    @property
    def quantity(self) -> Quantity:
        """As the reader of registers takes it."""
        return Quantity(self.address, self.type, self.scale, self.offset, tuple(self.invalid))


class AirSettings(DeviceSettings):
    """What a cell file may set of a Modbus air sensor."""

    map: Literal["vaisala", "comet_web", "comet_rtu", "generic"] = Field(
        default="vaisala", description="register map to start from; `generic` knows none."
    )
    device_id: int = Field(
        default=1, ge=0, le=255, description="unit identifier; most TCP sensors ignore it."
    )
    pressure_address: int | None = Field(
        default=None,
        ge=0,
        le=0xFFFF,
        description="register of the pressure, for a map that knows all but that.",
    )
    points: list[Point] = Field(
        default=[], description="quantities of the cell file's own; each replaces the map's."
    )
    function: Literal[3, 4] | None = Field(default=None, description="3 or 4.")
    word_order: WordOrder | None = Field(default=None, description="big or little.")
    address_base: Literal[0, 1] | None = Field(
        default=None, description="number that the documents give to the first register."
    )
    timeout_s: float = Field(default=3.0, gt=0, description="for connecting and for an answer, real s.")


_MAPS = {"vaisala": VAISALA, "comet_web": COMET_WEB, "comet_rtu": COMET_RTU, "generic": GENERIC}


def resolve(settings: AirSettings) -> RegisterMap:
    """Return the map that the settings describe.

    Raises:
        ProfileError: no quantity has an address, one has two, or one lies before the first register.
    """
    base = _MAPS[settings.map]
    named: dict[Name, Quantity] = base.quantities()
    if settings.pressure_address is not None:
        known = base.pressure or Quantity(0)
        named["pressure"] = replace(known, address=settings.pressure_address)
    named |= _own_points(settings.points)
    result = RegisterMap(
        base.title,
        temperature=named.get("temperature"),
        pressure=named.get("pressure"),
        humidity=named.get("humidity"),
        function=settings.function or base.function,
        word_order=settings.word_order or base.word_order,
        address_base=base.address_base if settings.address_base is None else settings.address_base,
    )
    if not named:
        raise ProfileError(
            f"environment map {settings.map!r}: no quantity has a register: write "
            "[[environment.settings.points]] with name, address and type for temperature, pressure and humidity"
        )
    if wrong := [name for name, quantity in named.items() if result.wire_address(quantity) < 0]:
        raise ProfileError(
            f"environment: {wrong[0]}: address 0 lies before address_base = 1: use 1 or more, or address_base = 0"
        )
    return result


def _own_points(points: Sequence[Point]) -> dict[Name, Quantity]:
    named = {point.name: point.quantity for point in points}
    if len(named) < len(points):
        twice = next(p.name for n, p in enumerate(points) if p.name in [q.name for q in points[:n]])
        raise ProfileError(f"environment: points name {twice} twice: leave one of them out")
    return named


def decode(words: Sequence[int], quantity: Quantity, word_order: WordOrder) -> float | None:
    """Return the value in registers; None when the sensor says that it has none (NaN, 0x8000, its own numbers).

    Args:
        words: as many registers as the quantity takes.
        word_order: `little` when the less significant word comes first.
    """
    if quantity.kind == "int16" and words[0] == _MISSING_INT16:
        return None
    ordered = words if word_order == "big" else words[::-1]
    (number,) = struct.unpack(_FORMATS[quantity.kind], b"".join(w.to_bytes(2, "big") for w in ordered))
    if math.isnan(number) or number in quantity.invalid:
        return None
    return float(number) * quantity.scale + quantity.offset


def check_plausible(name: Name, value: float | None, register_map: RegisterMap) -> None:
    """Refuse a value that no air around a robot has.

    Raises:
        ProtocolError: out of the limits; the text names the register and what to check.
    """
    low, high, unit = LIMITS[name]
    if value is None:
        return
    # A round number in the wrong word order is a float next to nothing, which lies within some limits.
    if not low <= value <= high or 0 < abs(value) < _TINY:
        raise ProtocolError(
            f"{register_map.label(name)} reads {value:.6g} {unit}, outside of {low:g}...{high:g} {unit}: check "
            f"word_order (now {register_map.word_order!r}), address_base, and address, type and scale in points"
        )
