"""Datagrams of real-time control: 196 bytes both ways, little-endian (sheet, section 2)."""

import math
import struct
from dataclasses import dataclass

PACKET_BYTES = 196

NO_COMMAND, MOVE, END = 0, 1, 255

_HEAD = struct.Struct("<4H40s6HI")
_MONITOR = struct.Struct("<2H40s")
_MONITORS = 3
_FLOATS = struct.Struct("<8f8x")
_POSE = struct.Struct("<8f2I")
_PULSES = struct.Struct("<8i8x")
_LARGEST_PULSES = 2**31 - 1
_LARGEST_FLAG = 2**32 - 1

NO_DATA = bytes(40)


class IllegalPacketError(ValueError):
    """A datagram that the controller does not accept."""


@dataclass(frozen=True)
class Request:
    """What a PC sends.

    Attributes:
        command: NO_COMMAND, MOVE or END.
        send_type: what the data are.
        wanted: types of data for the answer's first field and its three monitors.
        data: the set point.
        count: communication counter.
    """

    command: int
    send_type: int
    wanted: tuple[int, int, int, int]
    data: bytes
    count: int


def decode(datagram: bytes) -> Request:
    """Read a datagram.

    Raises:
        IllegalPacketError: another length, or an unknown command.
    """
    if len(datagram) != PACKET_BYTES:
        raise IllegalPacketError(f"{len(datagram)} bytes")
    command, send_type, first, _reserve, data, *_io, count = _HEAD.unpack_from(datagram)
    if command not in {NO_COMMAND, MOVE, END}:
        raise IllegalPacketError(f"command {command}")
    places = (_HEAD.size + n * _MONITOR.size for n in range(_MONITORS))
    second, third, fourth = (_MONITOR.unpack_from(datagram, place)[0] for place in places)
    return Request(command, send_type, (first, second, third, fourth), data, count)


def encode(request: Request, silent_cycles: int, data: tuple[bytes, bytes, bytes, bytes]) -> bytes:
    """Return the answer to a request.

    Args:
        silent_cycles: cycles without reception before it.
        data: what the wanted types stand for, 40 bytes each.
    """
    head = (request.command, request.send_type, request.wanted[0], 0, data[0], 0, 0, 0, 0, 0)
    monitors = zip(request.wanted[1:], data[1:], strict=True)
    return _HEAD.pack(*head, min(silent_cycles, 0xFFFF), request.count) + b"".join(
        _MONITOR.pack(kind, 0, content) for kind, content in monitors
    )


def numbers(data: bytes) -> tuple[float, ...]:
    """Return the eight numbers of joint or pose data.

    Raises:
        IllegalPacketError: one of them is no number.
    """
    values: tuple[float, ...] = _FLOATS.unpack(data)
    if not all(map(math.isfinite, values)):
        raise IllegalPacketError("a set point that is no number")
    return values


def pose_flags(data: bytes) -> tuple[int, int]:
    """Return the posture flags of pose data."""
    flag1, flag2 = _POSE.unpack(data)[8:]
    return flag1, flag2


def pulses(data: bytes) -> tuple[int, ...]:
    """Return the eight counts of pulse data."""
    counts: tuple[int, ...] = _PULSES.unpack(data)
    return counts


def number_data(values: tuple[float, ...]) -> bytes:
    """Return up to eight numbers as joint data."""
    return _FLOATS.pack(*(*values, *[0.0] * 8)[:8])


def pose_data(values: tuple[float, ...], flag1: int, flag2: int) -> bytes:
    """Return a position with its posture flags as pose data."""
    return _POSE.pack(*(*values, *[0.0] * 8)[:8], flag1 & _LARGEST_FLAG, flag2 & _LARGEST_FLAG)


def count_data(counts: tuple[float, ...]) -> bytes:
    """Return up to eight counts as pulse data or currents: whole numbers, clipped to what they hold."""
    whole = [max(-_LARGEST_PULSES, min(_LARGEST_PULSES, round(count))) for count in counts]
    return _PULSES.pack(*(*whole, *[0] * 8)[:8])
