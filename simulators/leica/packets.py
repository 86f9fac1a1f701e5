"""Bytes of emScon's interface (sheet `trackers_ballbar`, section 1): commands that come, packets that go.

Little-endian. Every packet begins with its size and its type.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from catseye.simulators.world.types import Floats

COMMAND, ERROR, SINGLE, MULTI = 0, 1, 2, 3
NIVEL, REFLECTOR_POSITION, STATE_CHANGED, SINGLE_2, MULTI_2 = 6, 7, 8, 9, 10

HEAD_BYTES = 12
LONGEST_BYTES = 1024
"""Of a command; none that is known is longer than 68."""


@dataclass(frozen=True)
class Command:
    """A command.

    Attributes:
        number: of the command.
        parameters: bytes behind its number.
        kind: type of its packet, 0 where the client knows the protocol.
    """

    number: int
    parameters: bytes
    kind: int = COMMAND


class CommandCutter:
    """Cuts commands out of the stream of a client; after a size that no command has, what has come is dropped."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> list[Command]:
        """Take bytes, cut anywhere; return the commands that are complete."""
        self._buffer += data
        found = []
        while len(self._buffer) >= HEAD_BYTES:
            size, kind, number = struct.unpack_from("<iii", self._buffer)
            if not HEAD_BYTES <= size <= LONGEST_BYTES:
                self._buffer = b""
                break
            if len(self._buffer) < size:
                break
            found.append(Command(number, self._buffer[HEAD_BYTES:size], kind))
            self._buffer = self._buffer[size:]
        return found


def reply(command: int, status: int, data: bytes = b"") -> bytes:
    """Return the reply to a command."""
    return struct.pack("<iiii", 16 + len(data), COMMAND, command, status) + data


def error(command: int, status: int) -> bytes:
    """Return an error that nobody asked for."""
    return struct.pack("<iiii", 16, ERROR, command, status)


def state_changed(code: int) -> bytes:
    """Return the news of a changed state."""
    return struct.pack("<iii", 12, STATE_CHANGED, code)


def name(text: str) -> bytes:
    """Return a name of 32 UTF-16 characters."""
    return text.encode("utf-16-le")[:62].ljust(64, b"\0")


def nivel(x: float, y: float, temperature: float) -> bytes:
    """Return the result of the inclination sensor."""
    return struct.pack("<iiiiddd", 40, NIVEL, 0, 0, x, y, temperature)


def reflector_position(values: Sequence[float]) -> bytes:
    """Return where the reflector is at this moment."""
    return struct.pack("<iiiddd", 36, REFLECTOR_POSITION, 0, *values)


@dataclass(frozen=True)
class PointValues:
    """A point in the client's units.

    Attributes:
        values: three coordinates.
        covariance: of the readings, shape (3, 3).
        a_priori: covariance that the maker expects, shape (3, 3).
    """

    values: Sequence[float]
    covariance: Floats
    a_priori: Floats


def single(mode: int, point: PointValues, air: Sequence[float], *, extended: bool) -> bytes:
    """Return the result of a stationary measurement.

    Args:
        mode: of measuring.
        air: temperature, pressure, humidity, in the client's units.
        extended: with covariances.
    """
    parts = [
        *point.values,
        *_deviations(point.covariance),
        *(_covariances(point.covariance) if extended else ()),
        0.0,
        0.0,
        0.0,
        *_deviations(point.a_priori),
        *(_covariances(point.a_priori) if extended else ()),
        *air,
    ]
    size, kind = (204, SINGLE_2) if extended else (156, SINGLE)
    return struct.pack(f"<iiiii{len(parts)}d", size, kind, 0, mode, 0, *parts)


def multi(
    mode: int, points: Sequence[tuple[float, PointValues]], air: Sequence[float], *, extended: bool
) -> bytes:
    """Return results of a continuous measurement.

    Args:
        points: with the time of each since the start, s.
        air: temperature, pressure, humidity, in the client's units.
        extended: with a-priori covariances.
    """
    body = b""
    for time_s, point in points:
        more = (*_deviations(point.a_priori), *_covariances(point.a_priori)) if extended else ()
        values = (*point.values, *more)
        seconds, microseconds = divmod(round(1e6 * time_s), 1_000_000)
        body += struct.pack(f"<iii{len(values)}d", 0, seconds, microseconds, *values)
    kind = MULTI_2 if extended else MULTI
    return struct.pack("<iiiiii3d", 48 + len(body), kind, 0, len(points), mode, 0, *air) + body


def _deviations(covariance: Floats) -> tuple[float, float, float, float]:
    """Return the standard deviations and their root sum of squares."""
    one, two, three = (max(0.0, float(covariance[i, i])) for i in range(3))
    return one**0.5, two**0.5, three**0.5, (one + two + three) ** 0.5


def _covariances(covariance: Floats) -> tuple[float, float, float]:
    return float(covariance[0, 1]), float(covariance[0, 2]), float(covariance[1, 2])
