"""The result of a stationary measurement, and the decoder that waits for it. Pure."""

import math
import operator
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from catseye.drivers.leica.codec import Kind, Packet, PacketDecoder, ReplyDecoder
from catseye.drivers.leica.commands import STATIONARY, Command
from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.tracker import Place

_HEAD: Final = struct.Struct("<iii")
_UNKNOWN_COMMAND: Final = 64
"""What an error that belongs to no command may name instead of one."""

_PLAIN: Final = {Kind.SINGLE: struct.Struct("<17d"), Kind.SINGLE_WITH_COVARIANCE: struct.Struct("<23d")}
"""Doubles of a result."""

_PLACE, _SCATTER, _A_PRIORI = slice(0, 3), slice(3, 6), slice(10, 13)
_COVARIANCES, _A_PRIORI_BEHIND, _A_PRIORI_COVARIANCES = slice(7, 10), slice(13, 16), slice(17, 20)
"""Where they stand; the three below in a result with covariances (xy, xz, yz), whose a-priori values stand later."""


@dataclass(frozen=True)
class StationaryResult:
    """What a measurement ended with.

    Attributes:
        status: 0 when there is a point.
        place_mm: x, y, z, mm.
        scatter_mm: standard deviations of the readings of this measurement, mm.
        a_priori_mm: standard deviations that the maker expects of the instrument there, mm.
        covariance_mm2: of x with y, x with z and y with z: both contributions; None where the server states none.
    """

    status: int
    place_mm: Place = (0.0, 0.0, 0.0)
    scatter_mm: Place = (0.0, 0.0, 0.0)
    a_priori_mm: Place = (0.0, 0.0, 0.0)
    covariance_mm2: Place | None = None

    @property
    def u_mm(self) -> Place:
        """Standard uncertainties of x, y and z, mm: both contributions, which are independent of each other."""
        x, y, z = map(math.hypot, self.scatter_mm, self.a_priori_mm)
        return x, y, z


def parse(packet: Packet) -> StationaryResult:
    """Return what a packet with a result says.

    Raises:
        ProtocolError: it is the result of another mode, or has values that are no numbers.
    """
    status, mode, _ = _HEAD.unpack_from(packet.body)
    if status:
        return StationaryResult(status)
    if mode != STATIONARY:
        raise ProtocolError(f"a result of the mode {mode} came")
    values = _PLAIN[packet.kind].unpack_from(packet.body, _HEAD.size)
    extended = packet.kind is Kind.SINGLE_WITH_COVARIANCE
    place, scatter = values[_PLACE], values[_SCATTER]
    a_priori = values[_A_PRIORI_BEHIND if extended else _A_PRIORI]
    covariance = _sum(values[_COVARIANCES], values[_A_PRIORI_COVARIANCES]) if extended else None
    if (
        not all(map(math.isfinite, place + scatter + a_priori + (covariance or ())))
        or min(scatter + a_priori) < 0.0
    ):
        raise ProtocolError(f"a result with the values {values}")
    return StationaryResult(0, place, scatter, a_priori, covariance)


def _sum(one: Sequence[float], other: Sequence[float]) -> Place:
    x, y, z = map(operator.add, one, other)
    return x, y, z


class ResultDecoder(PacketDecoder[StationaryResult]):
    """Takes the reply to the start of a measurement and then its result; a refusal or an error ends it, too."""

    def __init__(self) -> None:
        super().__init__()
        self._reply = ReplyDecoder(Command.START_MEASUREMENT)
        self._started = False

    def take(self, packet: Packet) -> StationaryResult | None:
        """Take a packet; return the result, or why there is none."""
        if self._started and packet.kind in _PLAIN:
            return parse(packet)
        if self._started and packet.kind is Kind.ERROR:
            return self._broken(packet)
        reply = self._reply.take(packet)
        if reply is not None and reply.status:
            return StationaryResult(reply.status)
        self._started |= reply is not None
        return None

    def _broken(self, packet: Packet) -> StationaryResult | None:
        command, status = struct.unpack_from("<ii", packet.body)
        ends = command in {Command.START_MEASUREMENT, _UNKNOWN_COMMAND} and status
        return StationaryResult(status) if ends else None
