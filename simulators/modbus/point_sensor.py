"""Air sensors described point by point: Comet's register map and maps of the cell file.

Comet (sheet `modbus_env`, section 2): one register each, signed, from address 0x31: temperature, humidity, computed
value (dew point here; it can be set on the device), pressure in hPa, dew point, absolute humidity in g/m³, specific
humidity and mixing ratio in g/kg, enthalpy in kJ/kg, all times 10; serial number and device type from 0x1035. What it
answers instead of a missing value is not in the public documents; here: 0x8000.
"""

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from catseye.simulators.errors import EmulatorError
from catseye.simulators.modbus.exceptions import ILLEGAL_ADDRESS, ModbusError
from catseye.simulators.modbus.tcp import Registers
from catseye.simulators.world.air import AirSample, dew_point_c
from catseye.simulators.world.air_probe import AirProbe

_FORMATS = {"float32": ">f", "int16": ">h", "uint16": ">H", "int32": ">i"}
_MISSING = {
    "float32": struct.pack(">f", math.nan),
    "int16": b"\x80\x00",
    "uint16": b"\xff\xff",
    "int32": b"\x80\x00\x00\x00",
}


def _vapour_hpa(air: AirSample) -> float:
    """Return the pressure of the vapour: that of saturation at the dew point (Magnus, Sonntag 1990)."""
    dew_c = dew_point_c(air.temperature_c, air.humidity_percent)
    return 6.112 * math.exp(17.62 * dew_c / (243.12 + dew_c))


def _mixing_ratio(air: AirSample) -> float:
    vapour_hpa = _vapour_hpa(air)
    return 621.98 * vapour_hpa / (air.pressure_hpa - vapour_hpa)


def _specific_humidity(air: AirSample) -> float:
    ratio = _mixing_ratio(air)
    return ratio / (1.0 + ratio / 1000.0)


def _absolute_humidity(air: AirSample) -> float:
    return 216.68 * _vapour_hpa(air) / (air.temperature_c + 273.15)


def _enthalpy(air: AirSample) -> float:
    ratio = _mixing_ratio(air) / 1000.0
    return 1.006 * air.temperature_c + ratio * (2501.0 + 1.86 * air.temperature_c)


_VALUES: dict[str, Callable[[AirSample], float]] = {
    "temperature": lambda air: air.temperature_c,
    "pressure": lambda air: air.pressure_hpa,
    "humidity": lambda air: air.humidity_percent,
    "dew_point": lambda air: dew_point_c(air.temperature_c, air.humidity_percent),
    "absolute_humidity": _absolute_humidity,
    "specific_humidity": _specific_humidity,
    "mixing_ratio": _mixing_ratio,
    "enthalpy": _enthalpy,
}


@dataclass(frozen=True)
class SensorPoint:
    """Where one quantity is.

    Attributes:
        name: temperature, pressure, humidity, dew_point, or one of the computed quantities.
        address: as transmitted.
        type: float32, int16, uint16 or int32.
        scale: value of one step.
        offset: value of the number 0.
    """

    name: str
    address: int
    type: str = "float32"
    scale: float = 1.0
    offset: float = 0.0

    def words(self, air: AirSample | None, *, little: bool) -> list[int]:
        """Return the registers; less significant word first when `little`."""
        data = _MISSING[self.type] if air is None else self._packed(_VALUES[self.name](air))
        words = [int.from_bytes(data[n : n + 2], "big") for n in range(0, len(data), 2)]
        return words[::-1] if little else words

    def _packed(self, value: float) -> bytes:
        number = (value - self.offset) / self.scale
        layout = _FORMATS[self.type]
        return struct.pack(layout, number if layout == ">f" else round(number))


def comet_points(base: int) -> tuple[SensorPoint, ...]:
    """Return the points of a Comet transmitter.

    Args:
        base: number that its documents give to the first register: 0 for Web Sensors, 1 for RS-485.
    """
    names = (
        *("temperature", "humidity", "dew_point", "pressure", "dew_point"),
        *("absolute_humidity", "specific_humidity", "mixing_ratio", "enthalpy"),
    )
    return tuple(SensorPoint(name, 0x31 - base + n, "int16", 0.1) for n, name in enumerate(names))


def read_points(device: str, tables: Sequence[Mapping[str, Any]], base: int) -> tuple[SensorPoint, ...]:
    """Return the points that a cell file describes.

    Args:
        tables: one table a point: name, address, type, scale, offset.
        base: number that the documents give to the first register.

    Raises:
        EmulatorError: there are none, or one is wrong.
    """
    if not tables:
        raise EmulatorError(f"{device}: option points has to list the registers of the map 'generic'")
    return tuple(_point(device, table, base) for table in tables)


def _point(device: str, given: Mapping[str, Any], base: int) -> SensorPoint:
    try:
        point = SensorPoint(
            str(given["name"]),
            int(given["address"]) - base,
            str(given.get("type", "float32")),
            float(given.get("scale", 1.0)),
            float(given.get("offset", 0.0)),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise EmulatorError(f"{device}: option points: {given!r} is no point: {error}") from None
    if point.name not in _VALUES or point.type not in _FORMATS or not point.scale or point.address < 0:
        raise EmulatorError(f"{device}: option points: {given!r} cannot be emulated")
    return point


class PointSensor(Registers):
    """Registers of the sensor; what lies between them does not exist.

    Args:
        little: less significant word first.
        fixed: registers with a fixed content, by address.
    """

    def __init__(
        self,
        probe: AirProbe,
        title: str,
        points: tuple[SensorPoint, ...],
        *,
        little: bool = False,
        fixed: Mapping[int, int] | None = None,
    ) -> None:
        self._probe = probe
        self._points = points
        self._little = little
        self._fixed = dict(fixed or {})
        self.identity = {0: "EMULATOR of catseye", 1: title, 2: "1.0"}

    def read_words(self, address: int, count: int) -> list[int]:
        """Return registers."""
        air = self._probe.sample()
        held = dict(self._fixed)
        for point in self._points:
            for n, word in enumerate(point.words(air, little=self._little)):
                held[point.address + n] = word
        try:
            return [held[address + n] for n in range(count)]
        except KeyError:
            raise ModbusError(ILLEGAL_ADDRESS) from None
