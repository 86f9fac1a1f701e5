"""What the emulated server says of itself and of the hardware behind it."""

import struct
from collections.abc import Callable
from typing import ClassVar

from catseye.simulators.leica import packets
from catseye.simulators.leica.coordinates import Units
from catseye.simulators.leica.parameters import REFLECTORS

VERSION = (3, 6, 0)
NAME = "AT901-MR EMULATOR"
SERIAL = 901_036

_SENSOR, _CONTROLLER, _PROCESSOR = 14, 6, 3
"""AT901-MR with an ATC900 and a 686."""

_ADM_READY = 2
_MAX_M, _MIN_M = 18.0, 0.5


class Information:
    """Answers to questions about hardware.

    Args:
        units: returns those that clients have set.
        has_nivel: there is an inclination sensor.
        has_weather: there is a weather station.

    Attributes:
        questions: answers by the number of their command.
    """

    COMPENSATION_SET: ClassVar[int] = 4
    INITIALISED: ClassVar[int] = 5
    LASER_HEATING: ClassVar[int] = 2
    LASER_READY: ClassVar[int] = 3
    LASER_OFF: ClassVar[int] = 5

    def __init__(self, units: Callable[[], Units], *, has_nivel: bool, has_weather: bool) -> None:
        self._units = units
        self._nivel = int(has_nivel)
        self._weather = int(has_weather)
        self.questions: dict[int, Callable[[], bytes]] = {
            86: lambda: struct.pack("<2i", 1, 1) + self._compensation() + struct.pack("<i", 0),
            89: lambda: struct.pack("<3i", *VERSION[:2], SERIAL),
            90: lambda: struct.pack("<10i", *VERSION[:2] * 3, _CONTROLLER, _PROCESSOR, 0, _SENSOR),
            91: lambda: struct.pack("<3i", *VERSION[:2], SERIAL),
            123: lambda: (
                struct.pack("<2i", 1, 1) + self._compensation() + _padded(256) + struct.pack("<2i", 0, 1)
            ),
            131: self._distance_meter,
            132: self._tracker,
            133: lambda: (
                struct.pack("<i", 2 * self._nivel)
                + packets.name("NIVEL230 EMULATOR")
                + struct.pack("<3i3d", SERIAL, *VERSION[:2], 1.5e-3, 2e-6, 5e-3)
            ),
            138: lambda: (
                struct.pack("<i", 0) + packets.name("") + struct.pack("<6i4d", *(0,) * 6, *(0.0,) * 4)
            ),
            139: lambda: (
                struct.pack("<i", 2 * self._weather)
                + packets.name("AT EMULATOR")
                + struct.pack("<2i", *VERSION[:2])
            ),
            142: lambda: packets.name("EMULATOR 3.6.0"),
        }

    def system_status(self, last: int, processor: int, laser: int, weather: int) -> bytes:
        """Return the data of the status of the whole system."""
        return struct.pack("<10i", last, processor, laser, _ADM_READY, *VERSION, weather, 0, SERIAL)

    def reflectors(self) -> bytes:
        """Return the replies to the question for all reflectors: a packet each."""
        units = self._units()
        return b"".join(
            packets.reply(
                42,
                0,
                struct.pack("<3id", len(REFLECTORS), number, kind, units.length(1000.0 * offset_m))
                + packets.name(name),
            )
            for number, (name, kind, offset_m) in enumerate(REFLECTORS, 1)
        )

    def _tracker(self) -> bytes:
        length = self._units().length
        return (
            struct.pack("<i", _SENSOR)
            + packets.name(NAME)
            + struct.pack("<5i", SERIAL, 1, 1, 0, self._nivel)
            + struct.pack("<3d", 0.0, length(1000.0 * _MAX_M), length(1000.0 * _MIN_M))
            + struct.pack("<2i2d3i", 1000, 2, 360.0, 90.0, 1, *VERSION[:2])
        )

    def _distance_meter(self) -> bytes:
        length = self._units().length
        return (
            struct.pack("<i", 2)
            + packets.name("AIFM EMULATOR")
            + struct.pack("<3i", SERIAL, *VERSION[:2])
            + struct.pack("<2did", length(1000.0 * _MAX_M), length(1000.0 * _MIN_M), 1000, length(0.01))
        )

    def _compensation(self) -> bytes:
        return packets.name("EMULATOR") + _padded(256) + packets.name("EMULATOR")


def _padded(size: int) -> bytes:
    return bytes(size)
