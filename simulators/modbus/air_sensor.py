"""Register map common to Vaisala instruments (sheet `modbus_env`, section 1a).

32-bit floats at PDU 0x0000…, least significant word first; the same quantities as scaled 16-bit integers from 0x0100;
status from 0x0200, again as outputs of function 07 and as the diagnostic register of function 08 (manuals as in
`diagnostics`); registers with known values from 0x1F00. Quantities of the map that are not measured here read as
missing: NaN, 0x8000.
"""

import math
import struct

from catseye.simulators.modbus.diagnostics import Diagnostics
from catseye.simulators.modbus.exceptions import ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, ModbusError
from catseye.simulators.modbus.tcp import Registers
from catseye.simulators.world.air import dew_point_c
from catseye.simulators.world.air_probe import AirProbe

MISSING = 0x8000

_FLOAT_WORDS = 0x80
_INTEGERS_FROM = 0x0100
_STATUS_FROM = 0x0200
_STATUS_OUTPUTS = 3
_TEST_FROM = 0x1F00
_SETTINGS_FROM = 0x0300
_SETTINGS_WORDS = 22

_SIMPLE_LACK = frozenset({1, 2, 5, 7, 8, 15, 22, 23})

# PDU address of the float and scale of the integer; the integer stands at 0x0100 + address / 2.
_HUMIDITY, _TEMPERATURE, _DEW_POINT = 0x0000, 0x0002, 0x0006
_INTEGER_STEP = {_HUMIDITY: 0.01, _TEMPERATURE: 0.01, _DEW_POINT: 0.01}
_PRESSURE_STEP_HPA = 0.1


_IDENTITY = {
    0: "EMULATOR of catseye",
    1: "air sensor, common register map",
    2: "1.0",
    3: "http://emulator.invalid/",
    4: "EMULATOR",
    5: "EMULATOR",
    0x80: "EMU00001",
    0x81: "2026-01-01",
    0x82: "EMULATOR",
}
"""Vendor, product code, version, address, name, model; serial number, date and text of the calibration."""


class AirSensor(Registers):
    """Registers of the sensor.

    Args:
        pressure_register: PDU address of the pressure in hPa; the sheet does not know that of a PTU300.
        error_bit: of the 32 error bits, the one that stands for a sensor without values.
        diagnostics: it has the functions of large transmitters, 07, 08 and 22 among them (manual of MMT330,
            table 33); otherwise those of HMW90 (its manual, table 39).
    """

    def __init__(
        self, probe: AirProbe, pressure_register: int, *, error_bit: int = 0, diagnostics: bool = True
    ) -> None:
        self._probe = probe
        self._pressure_register = pressure_register
        self._error = 1 << error_bit
        self._settings = [0] * _SETTINGS_WORDS
        self.diagnostics = Diagnostics() if diagnostics else None
        self.lacks = frozenset() if diagnostics else _SIMPLE_LACK
        self.identity = dict(_IDENTITY)

    def read_words(self, address: int, count: int) -> list[int]:
        """Return registers; a range must lie within one part of the map."""
        for start, words in (
            (0, self._floats),
            (_INTEGERS_FROM, self._integers),
            (_STATUS_FROM, self._status),
            (_TEST_FROM, _test_words),
        ):
            part = words()
            if start <= address and address + count <= start + len(part):
                return part[address - start : address - start + count]
        start = self._setting(address, count)
        return self._settings[start : start + count]

    def write_words(self, address: int, words: list[int]) -> None:
        """Write settings; measured values cannot be written. The settings are kept and have no effect."""
        start = self._setting(address, len(words))
        self._settings[start : start + len(words)] = words

    def exception_status(self) -> int:
        """Return fault status, online status and pressure stability, one bit each; 1 is good."""
        if self.diagnostics is None:
            raise ModbusError(ILLEGAL_FUNCTION)
        return sum(word << n for n, word in enumerate(self._status()[:_STATUS_OUTPUTS]))

    def diagnostic_register(self) -> int:
        """Return the error bits, the two words joined by OR."""
        low, high = self._error_words()
        return low | high

    def _setting(self, address: int, count: int) -> int:
        start = address - _SETTINGS_FROM
        if start < 0 or start + count > _SETTINGS_WORDS:
            raise ModbusError(ILLEGAL_ADDRESS)
        return start

    def _values(self) -> dict[int, float]:
        shown = self._probe.sample()
        if shown is None:
            return {}
        return {
            _HUMIDITY: shown.humidity_percent,
            _TEMPERATURE: shown.temperature_c,
            _DEW_POINT: dew_point_c(shown.temperature_c, shown.humidity_percent),
            self._pressure_register: shown.pressure_hpa,
        }

    def _floats(self) -> list[int]:
        size = max(_FLOAT_WORDS, self._pressure_register + 2)
        words = [*_float_words(math.nan)] * (size // 2) + [0] * (size % 2)
        for address, value in self._values().items():
            words[address : address + 2] = _float_words(value)
        return words

    def _integers(self) -> list[int]:
        words = [MISSING] * (_FLOAT_WORDS // 2)
        steps = {**_INTEGER_STEP, self._pressure_register: _PRESSURE_STEP_HPA}
        for address, value in self._values().items():
            if address // 2 < len(words):
                words[address // 2] = round(value / steps[address]) & 0xFFFF
        return words

    def _status(self) -> list[int]:
        good = int(self._probe.sample() is not None)
        return [good, good, good, *self._error_words(), 0]

    def _error_words(self) -> tuple[int, int]:
        error = self._error if self._probe.sample() is None else 0
        return error & 0xFFFF, error >> 16


def _test_words() -> list[int]:
    """Return the known values: -12345, -123.45 and its text (manuals of DMT143, HMM170, HMDW110, HMP4)."""
    return [-12345 & 0xFFFF, *_float_words(-123.45), *struct.unpack(">4H", b"-123.45\0")]


def _float_words(value: float) -> tuple[int, int]:
    high, low = struct.unpack(">HH", struct.pack(">f", value))
    return low, high
