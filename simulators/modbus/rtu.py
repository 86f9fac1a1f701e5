"""Modbus RTU (MODBUS over Serial Line): address, request, CRC 16, an end by silence.

A request to another address or with a wrong CRC is answered by silence; address 0 is a broadcast: it is carried out
and not answered.
"""

from collections import deque
from collections.abc import Callable

from catseye.simulators.modbus.diagnostics import Diagnostics
from catseye.simulators.modbus.tcp import Registers, respond
from catseye.simulators.ports.session import Answer, Session

_LONGEST_BYTES = 256
_SHORTEST_BYTES = 4
_MOST_WAITING = 16
_BROADCAST = 0

SHORTEST_SILENCE_S = 0.00175
"""Of 3.5 characters at more than 19200 Bd, by the specification."""


def crc16(data: bytes) -> bytes:
    """Return the check bytes of a frame, low byte first (polynomial 0xA001, initial value 0xFFFF)."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return value.to_bytes(2, "little")


class RtuSession(Session):
    """Conversation over one line.

    Args:
        unit: its address, 1...247.
        note: called with each request.
        silence_s: what ends a request, real s.
    """

    def __init__(
        self,
        registers: Registers,
        unit: int,
        note: Callable[[str], None],
        silence_s: float = SHORTEST_SILENCE_S,
    ) -> None:
        self._registers = registers
        self._counted = registers.diagnostics or Diagnostics()
        self._unit = unit
        self._note = note
        self._silence_s = silence_s
        self._bytes = bytearray()
        self._frames: deque[bytes] = deque(maxlen=_MOST_WAITING)

    def feed(self, data: bytes) -> None:
        """Take bytes; of a frame that is too long only so much is kept that it stays too long."""
        self._bytes += data
        del self._bytes[_LONGEST_BYTES + 1 :]

    def silence_s(self) -> float | None:
        """Return what ends a frame."""
        return self._silence_s if self._bytes else None

    def idle(self) -> None:
        """Take what has come as one frame."""
        frame = bytes(self._bytes)
        self._bytes.clear()
        if _SHORTEST_BYTES <= len(frame) <= _LONGEST_BYTES and crc16(frame[:-2]) == frame[-2:]:
            self._counted.messages += 1
            self._frames.append(frame)
        else:
            self._counted.frame_errors += 1

    def answer(self) -> Answer | None:
        """Carry out the next request."""
        if not self._frames:
            return None
        frame = self._frames.popleft()
        unit, pdu = frame[0], frame[1:-2]
        if unit not in {self._unit, _BROADCAST}:
            return b""
        self._note(pdu.hex(" "))
        reply = respond(self._registers, pdu, broadcast=unit == _BROADCAST)
        if not reply:
            return b""
        frame = bytes([self._unit]) + reply
        return frame + crc16(frame)
