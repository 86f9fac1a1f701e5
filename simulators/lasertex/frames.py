"""Frames of the Lasertex HPI-3D (sheet `interferometers`, section 2): the instrument's side."""

import struct
from typing import TypedDict, Unpack

COMMAND_BYTES = 8

_START = 0xAA


class Flags(TypedDict):
    """What distance and velocity frames carry besides their value; `level` is 0...255."""

    overspeed: bool
    laser_ready: bool
    signal_ok: bool
    level: int


def crc8(data: bytes) -> int:
    """Return the checksum of a frame."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc << 1 ^ (0x131 if crc & 0x80 else 0)
    return crc


def frame(code: int, data: bytes) -> bytes:
    """Return a frame of the instrument; data are filled up to 12 bytes with zeros."""
    head = struct.pack(">BH12s", _START, code, data)
    return head + struct.pack("B", crc8(head))


class CommandCutter:
    """Cuts commands out of what a client sends; what is no command is passed over in silence."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[int]:
        """Take bytes, cut anywhere; return the codes of the commands that are complete."""
        self._rest += data
        codes: list[int] = []
        at = self._rest.find(_START)
        while 0 <= at <= len(self._rest) - COMMAND_BYTES:
            piece = self._rest[at : at + COMMAND_BYTES]
            right = crc8(piece[:-1]) == piece[-1]
            if right:
                codes.append(int.from_bytes(piece[1:3], "big"))
            at = self._rest.find(_START, at + (COMMAND_BYTES if right else 1))
        self._rest = self._rest[at:] if at >= 0 else b""
        return codes


def distance(length_mm: float, **flags: Unpack[Flags]) -> bytes:
    """Return a distance frame; the length goes in steps of 100 pm."""
    count = round(length_mm * 1e7).to_bytes(7, "big", signed=True)
    return frame(0xB015, count + b"\0\0" + _flags(flags))


def velocity(rate_mm_s: float, **flags: Unpack[Flags]) -> bytes:
    """Return a velocity frame; the rate goes in steps of 100 nm/s."""
    limit = 2**31 - 1
    count = max(-limit, min(limit, round(rate_mm_s * 1e4)))
    return frame(0xB016, struct.pack(">i5x", count) + _flags(flags))


def meteo(
    sensor: int, temperature_c: float, humidity_percent: float = 0.0, pressure_hpa: float = 0.0
) -> bytes:
    """Return a frame of a sensor with full battery and radio link: 0 is that of the air, others are of material."""
    data = struct.pack(
        ">BhBBBh",
        sensor,
        round(temperature_c * 100),
        round(humidity_percent),
        100,
        100,
        round(pressure_hpa * 10),
    )
    return frame(0xB00A, data)


def _flags(flags: Flags) -> bytes:
    ready = 0x01 * flags["laser_ready"] | 0x08 * flags["signal_ok"]
    return bytes((0x08 * flags["overspeed"], ready, flags["level"]))
