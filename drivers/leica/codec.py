"""Packets of emScon's programming interface (TPI), in both directions (sheet `trackers_ballbar`, section 1). Pure.

Little-endian: size of the whole packet, its type, and what belongs to the type. The controller may send packets that
nobody asked for between any two others: errors, positions of the reflector, changes of its state.
"""

import struct
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, Generic, TypeVar

from catseye.drivers.roles.errors import ProtocolError

T = TypeVar("T")

_HEADER: Final = struct.Struct("<ii")
_REPLY: Final = struct.Struct("<ii")
_SHORTEST_BYTES: Final = 12
_LONGEST_BYTES: Final = 65_536
_LONGEST_REPLY_BYTES: Final = 4096
_MOST_REPLIES: Final = 1000


class Kind(IntEnum):
    """Types of packets."""

    REPLY = 0
    ERROR = 1
    SINGLE = 2
    MULTI = 3
    STATIONARY_PROBE = 4
    CONTINUOUS_PROBE = 5
    NIVEL = 6
    REFLECTOR_POSITION = 7
    STATE_CHANGED = 8
    SINGLE_WITH_COVARIANCE = 9
    MULTI_WITH_COVARIANCE = 10
    PROBE_POSITION = 11


_SIZES: Final[dict[Kind, tuple[int, int]]] = {
    Kind.ERROR: (16, 0),
    Kind.SINGLE: (156, 0),
    Kind.MULTI: (48, 36),
    Kind.STATIONARY_PROBE: (376, 0),
    Kind.CONTINUOUS_PROBE: (68, 212),
    Kind.NIVEL: (40, 0),
    Kind.REFLECTOR_POSITION: (36, 0),
    Kind.STATE_CHANGED: (12, 0),
    Kind.SINGLE_WITH_COVARIANCE: (204, 0),
    Kind.MULTI_WITH_COVARIANCE: (48, 92),
    Kind.PROBE_POSITION: (108, 0),
}
"""Bytes of a packet, and of each result in one that holds several."""


@dataclass(frozen=True)
class Packet:
    """A packet without its header."""

    kind: Kind
    body: bytes


@dataclass(frozen=True)
class Reply:
    """What a command is answered by.

    Attributes:
        status: 0 when it was carried out.
        data: what was asked for; of a refused command there may be none.
    """

    status: int
    data: bytes

    def values(self, layout: str) -> tuple[float, ...]:
        """Return the numbers that the data begin with.

        Args:
            layout: of them, as in the module struct, without its byte order; whole numbers and doubles only.

        Raises:
            ProtocolError: there are fewer.
        """
        try:
            return struct.unpack_from(f"<{layout}", self.data)
        except struct.error:
            raise ProtocolError(f"a reply of {len(self.data)} bytes instead of {layout!r}") from None


def encode(command: int, layout: str = "", *values: float) -> bytes:
    """Return the packet of a command.

    Args:
        layout: of its parameters, as in the module struct, without its byte order.
        values: its parameters.
    """
    parameters = struct.pack(f"<{layout}", *values)
    return struct.pack("<iii", _SHORTEST_BYTES + len(parameters), Kind.REPLY, command) + parameters


def name_of(data: bytes) -> str:
    """Return a name of 32 UTF-16 characters, up to the first that is zero."""
    return data.decode("utf-16-le", errors="replace").partition("\0")[0]


def cut(buffer: bytes) -> tuple[Packet | None, bytes]:
    """Return the first packet of a stream and what follows; None while it is not complete.

    Raises:
        ProtocolError: no packet begins like this.
    """
    if len(buffer) < _HEADER.size:
        return None, buffer
    size, number = _HEADER.unpack_from(buffer)
    kind = _kind(number)
    _check_size(kind, size)
    if len(buffer) < size:
        return None, buffer
    return Packet(kind, buffer[_HEADER.size : size]), buffer[size:]


def _kind(number: int) -> Kind:
    try:
        return Kind(number)
    except ValueError:
        raise ProtocolError(f"a packet of the unknown type {number}") from None


def _check_size(kind: Kind, size: int) -> None:
    if kind is Kind.REPLY:
        fits = 16 <= size <= _LONGEST_REPLY_BYTES
    else:
        fixed, each = _SIZES[kind]
        fits = size == fixed if not each else fixed <= size <= _LONGEST_BYTES and (size - fixed) % each == 0
    if not fits:
        raise ProtocolError(f"a packet of type {kind.value} with {size} bytes")


UNASKED: Final = frozenset({Kind.ERROR, Kind.REFLECTOR_POSITION, Kind.STATE_CHANGED, Kind.PROBE_POSITION})
"""Packets that may come at any time."""


class PacketDecoder(ABC, Generic[T]):
    """Takes packets until something is complete; those that nobody asked for are passed over."""

    may_end = False
    """Silence never ends a packet."""

    def __init__(self) -> None:
        self.rest = b""

    def feed(self, data: bytes) -> T | None:
        """Take a chunk; return what was asked for when it is complete.

        Raises:
            ProtocolError: no packet, or the answer to something else.
        """
        self.rest += data
        while True:
            packet, self.rest = cut(self.rest)
            if packet is None:
                return None
            done = self.take(packet)
            if done is not None:
                self.rest = without_unasked(self.rest)
                return done

    def end(self) -> T:
        """Refuse: silence does not end a packet.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a packet without its end")

    @abstractmethod
    def take(self, packet: Packet) -> T | None:
        """Take a packet; return what was asked for when it is complete.

        Raises:
            ProtocolError: it answers something else.
        """


def without_unasked(rest: bytes) -> bytes:
    """Return bytes without the whole packets at their beginning that may come at any time."""
    while True:
        try:
            packet, behind = cut(rest)
        except ProtocolError:
            return rest
        if packet is None or packet.kind not in UNASKED:
            return rest
        rest = behind


class ReplyDecoder(PacketDecoder[Reply]):
    """Takes the reply to a command; what an earlier measurement still sends is passed over."""

    def __init__(self, command: int) -> None:
        super().__init__()
        self._command = command

    def take(self, packet: Packet) -> Reply | None:
        """Take a packet; return the reply if it is one, also one that is sent as an error."""
        if packet.kind not in {Kind.REPLY, Kind.ERROR}:
            return None
        command, status = _REPLY.unpack_from(packet.body)
        if command == self._command:
            return Reply(status, packet.body[_REPLY.size :])
        if packet.kind is Kind.REPLY:
            raise ProtocolError(f"command {command} is answered instead of {self._command}")
        return None


class RepliesDecoder(PacketDecoder[tuple[Reply, ...]]):
    """Takes replies to one command that come in packets of their own; each says first how many there are."""

    def __init__(self, command: int) -> None:
        super().__init__()
        self._one = ReplyDecoder(command)
        self._replies: tuple[Reply, ...] = ()

    def take(self, packet: Packet) -> tuple[Reply, ...] | None:
        """Take a packet; return all replies with the last, or with one that refuses."""
        reply = self._one.take(packet)
        if reply is None:
            return None
        self._replies += (reply,)
        if reply.status:
            return self._replies
        total = int(reply.values("i")[0])
        if not 0 < total <= _MOST_REPLIES:
            raise ProtocolError(f"{total} replies are announced")
        return self._replies if len(self._replies) >= total else None
