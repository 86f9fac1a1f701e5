"""Datagrams of the real-time control MXT: 196 bytes both ways, little-endian (sheet, section 2). Pure.

In joint data a SCARA's J3 is in mm, the other axes are in rad.
"""

import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.pose import Pose

PACKET_BYTES = 196


class Command(IntEnum):
    """What a datagram asks for."""

    NONE = 0
    MOVE = 1
    END = 255


class Kind(IntEnum):
    """What the 40 bytes of a data field are."""

    NULL = 0
    JOINT_COMMAND = 2
    JOINT_FILTERED = 5
    JOINT_FEEDBACK = 8
    CURRENT_FEEDBACK = 11


_HEAD = struct.Struct("<4H40s5H")
_COUNTERS = struct.Struct("<HI")
_MONITOR = struct.Struct("<2H40s")
_AXES = struct.Struct("<8f8x")
_COUNTS = struct.Struct("<8i8x")
_NO_DATA = bytes(40)
_MONITORS = 3
_TO_RAD = math.pi / 180.0


@dataclass(frozen=True)
class Reply:
    """What the controller sent in one cycle.

    Attributes:
        command: command field.
        t_count: cycles of the controller without reception.
        c_count: communication counter.
        axes: the first field and the monitors by kind: eight numbers each, as they came (rad, J3 mm; currents are
            whole numbers, likely % of rated).
    """

    command: int
    t_count: int
    c_count: int
    axes: dict[int, tuple[float, ...]]

    def joints(self, kind: Kind) -> Pose | None:
        """Return one kind of joint data: J1 deg, J2 deg, J3 mm, J4 deg; None when it did not come."""
        axes = self.axes.get(kind)
        if axes is None:
            return None
        return math.degrees(axes[0]), math.degrees(axes[1]), axes[2], math.degrees(axes[3])


def encode(command: Command, count: int, target: Pose | None = None) -> bytes:
    """Return a datagram that asks for command, filtered command, feedback and current in the answer.

    Args:
        command: NONE asks where the arm stands, MOVE gives a set point, END ends the control.
        count: communication counter.
        target: set point, J1 deg, J2 deg, J3 mm, J4 deg.

    Raises:
        ValueError: a joint is not finite, or MOVE has no target.
    """
    if (target is None) == (command is Command.MOVE):
        raise ValueError(f"an MXT {command.name} with target {target}")
    kind, data = (Kind.NULL, _NO_DATA) if target is None else (Kind.JOINT_COMMAND, _joints_data(target))
    head = _HEAD.pack(command, kind, Kind.JOINT_COMMAND, 0, data, 0, 0, 0, 0, 0)
    wanted = (Kind.JOINT_FILTERED, Kind.JOINT_FEEDBACK, Kind.CURRENT_FEEDBACK)
    monitors = b"".join(_MONITOR.pack(monitor, 0, _NO_DATA) for monitor in wanted)
    return head + _COUNTERS.pack(0, count & 0xFFFFFFFF) + monitors


def decode(data: bytes) -> Reply:
    """Read a datagram of the controller.

    Raises:
        ProtocolError: another length, or numbers that are none.
    """
    if len(data) != PACKET_BYTES:
        raise ProtocolError(f"an MXT datagram has {PACKET_BYTES} bytes, this one has {len(data)}")
    command, _sent, kind, _reserve, first, *_io = _HEAD.unpack_from(data)
    t_count, c_count = _COUNTERS.unpack_from(data, _HEAD.size)
    fields = [(kind, first)]
    for number in range(_MONITORS):
        monitor, _reserve, content = _MONITOR.unpack_from(
            data, _HEAD.size + _COUNTERS.size + number * _MONITOR.size
        )
        fields.append((monitor, content))
    axes = {kind: _READS[kind](content) for kind, content in fields if kind in _READS}
    return Reply(command, t_count, c_count, axes)


def _joints_data(target: Pose) -> bytes:
    if not all(map(math.isfinite, target)):
        raise ValueError(f"joints of a set point must be finite numbers, got {target}")
    j1, j2, j3, j4 = target
    return _AXES.pack(j1 * _TO_RAD, j2 * _TO_RAD, j3, j4 * _TO_RAD, 0.0, 0.0, 0.0, 0.0)


def _numbers(content: bytes) -> tuple[float, ...]:
    numbers: tuple[float, ...] = _AXES.unpack(content)
    if not all(map(math.isfinite, numbers)):
        raise ProtocolError(f"an MXT datagram holds numbers that are none: {numbers}")
    return numbers


def _counts(content: bytes) -> tuple[float, ...]:
    return tuple(map(float, _COUNTS.unpack(content)))


_READS: Mapping[int, Callable[[bytes], tuple[float, ...]]] = {
    Kind.JOINT_COMMAND: _numbers,
    Kind.JOINT_FILTERED: _numbers,
    Kind.JOINT_FEEDBACK: _numbers,
    Kind.CURRENT_FEEDBACK: _counts,
}
"""How the eight numbers of each kind that is asked for are read."""
