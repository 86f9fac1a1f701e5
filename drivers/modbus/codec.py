"""Modbus requests and answers as bytes, and their frames over TCP (MBAP header) and as RTU (check sum). Pure."""

import struct
from collections.abc import Sequence

from catseye.drivers.roles.errors import ProtocolError

READ_COILS, READ_INPUTS = 1, 2
READ_HOLDING, READ_INPUT_REGISTERS = 3, 4
WRITE_COILS = 15
IDENTIFY = 43

_REFUSED = 0x80
_DEVICE_IDENTIFICATION = 14
_BASIC = 1
_OBJECTS = 7
"""Where they begin in an identification; their number stands before them."""

_LONGEST_PDU_BYTES = 253
_MBAP_BYTES = 7
_SHORTEST_RTU_BYTES = 5
_CONFIRMATION_BYTES = 8
_MOST_GARBAGE_BYTES = 256


def read_request(function: int, address: int, count: int) -> bytes:
    """Return the request for coils, inputs or registers from an address on."""
    return struct.pack(">BHH", function, address, count)


def write_coils_request(address: int, bits: Sequence[bool]) -> bytes:
    """Return the request that sets coils from an address on."""
    packed = sum(bit << place for place, bit in enumerate(bits)).to_bytes((len(bits) + 7) // 8, "little")
    return struct.pack(">BHHB", WRITE_COILS, address, len(bits), len(packed)) + packed


def identify_request() -> bytes:
    """Return the request for the basic objects of function 43/14."""
    return bytes([IDENTIFY, _DEVICE_IDENTIFICATION, _BASIC, 0])


def exception_of(answer: bytes) -> int:
    """Return the number of the exception that an answer is; 0 when it is none."""
    return answer[1] if answer[0] & _REFUSED else 0


def parse_registers(count: int, answer: bytes) -> list[int]:
    """Return the registers in an answer to a request for so many.

    Raises:
        ProtocolError: its length is not what it says, or others came.
    """
    data = _counted(answer)
    if len(data) != 2 * count:
        raise ProtocolError(f"{len(data) / 2:g} registers came")
    return [word for (word,) in struct.iter_unpack(">H", data)]


def parse_bits(count: int, answer: bytes) -> list[bool]:
    """Return the coils or inputs in an answer to a request for so many.

    Raises:
        ProtocolError: its length is not what it says, or too few came.
    """
    bits = [bool(byte >> place & 1) for byte in _counted(answer) for place in range(8)]
    if len(bits) < count:
        raise ProtocolError(f"{len(bits)} bits came")
    return bits[:count]


def parse_objects(answer: bytes) -> dict[int, str]:
    """Return the objects of function 43/14 by their numbers.

    Raises:
        ProtocolError: its length is not what it says.
    """
    if _identification_length(answer) != len(answer):
        raise ProtocolError(f"an identification of {len(answer)} bytes came, which is not what it says")
    objects: dict[int, str] = {}
    at = _OBJECTS
    while at < len(answer):
        end = at + 2 + answer[at + 1]
        objects[answer[at]] = answer[at + 2 : end].decode("latin-1")
        at = end
    return objects


def check_written(request: bytes, answer: bytes) -> None:
    """Compare the answer to a request that sets coils with it: address and count come back.

    Raises:
        ProtocolError: they are others.
    """
    if answer != request[:5]:
        raise ProtocolError(f"{answer.hex(' ')} confirms another request")


def _counted(answer: bytes) -> bytes:
    if len(answer) < 2 or answer[1] != len(answer) - 2:
        raise ProtocolError(f"{len(answer) - 2} bytes came, which is not what the answer says")
    return answer[2:]


class _Decoder:
    """Takes the answer to one request.

    Args:
        device_id: unit identifier that was asked; 0 takes any.
    """

    may_end = False
    """Silence never ends an answer."""

    def __init__(self, number: int, device_id: int, function: int) -> None:
        self._number = number
        self._device_id = device_id
        self._function = function
        self._buffer = b""
        self.rest = b""

    def end(self) -> bytes:
        """Refuse: silence does not end an answer.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("an answer without end")

    def _fits(self, device_id: int, function: int) -> bool:
        return self._device_id in {0, device_id} and function & ~_REFUSED == self._function

    def _cut(self, length: int) -> bytes:
        """Take so much from the beginning of what has come."""
        frame, self._buffer = self._buffer[:length], self._buffer[length:]
        return frame


class TcpDecoder(_Decoder):
    """Takes an answer over TCP, which has the number of its request: a late one to another request is left out."""

    @staticmethod
    def frame(number: int, device_id: int, request: bytes) -> bytes:
        """Return a request as sent."""
        return struct.pack(">HHHB", number, 0, len(request) + 1, device_id) + request

    def feed(self, data: bytes) -> bytes | None:
        """Take a chunk; return the answer when it is complete.

        Raises:
            ProtocolError: it is no Modbus, or no answer to this request.
        """
        self._buffer += data
        while len(self._buffer) > _MBAP_BYTES:
            number, protocol, length, device_id = struct.unpack_from(">HHHB", self._buffer)
            if protocol or not 3 <= length <= _LONGEST_PDU_BYTES + 1:
                raise ProtocolError("no header of Modbus TCP")
            if len(self._buffer) < _MBAP_BYTES - 1 + length:
                return None
            answer = self._cut(_MBAP_BYTES - 1 + length)[_MBAP_BYTES:]
            if number != self._number:
                continue
            if not self._fits(device_id, answer[0]):
                raise ProtocolError(f"unit {device_id} answered function {answer[0]}")
            self.rest = self._buffer
            return answer
        return None


class RtuDecoder(_Decoder):
    """Takes an answer over RTU: what a line that is turned round brings before it is left out."""

    @staticmethod
    def frame(_number: int, device_id: int, request: bytes) -> bytes:
        """Return a request as sent."""
        data = bytes([device_id]) + request
        return data + check_sum(data)

    def feed(self, data: bytes) -> bytes | None:
        """Take a chunk; return the answer when it is complete.

        Raises:
            ProtocolError: the check sum is wrong, or nothing begins like an answer.
        """
        self._buffer += data
        garbage = 0
        while garbage + 1 < len(self._buffer) and not self._fits(*self._buffer[garbage : garbage + 2]):
            garbage += 1
        if garbage > _MOST_GARBAGE_BYTES:
            raise ProtocolError("nothing begins like an answer")
        length = self._length(self._buffer[garbage:])
        if length is None or len(self._buffer) < garbage + length:
            return None
        frame = self._cut(garbage + length)[garbage:]
        if check_sum(frame[:-2]) != frame[-2:]:
            raise ProtocolError("a wrong check sum")
        self.rest = self._buffer
        return frame[1:-2]

    def _length(self, frame: bytes) -> int | None:
        """Return how long a frame is that begins so; None until that is known."""
        if len(frame) < _SHORTEST_RTU_BYTES:
            return None
        if frame[1] & _REFUSED:
            return _SHORTEST_RTU_BYTES
        if self._function == WRITE_COILS:
            return _CONFIRMATION_BYTES
        if self._function != IDENTIFY:
            return _SHORTEST_RTU_BYTES + frame[2]
        length = _identification_length(frame[1:])
        return length and length + 3


def _identification_length(answer: bytes) -> int | None:
    """Return how long an identification is that begins so; None until that is known."""
    at = _OBJECTS
    if len(answer) < at:
        return None
    for _ in range(answer[at - 1]):
        if len(answer) < at + 2:
            return None
        at += 2 + answer[at + 1]
    return at


def check_sum(data: bytes) -> bytes:
    """Return the CRC-16 of an RTU frame, its low byte first."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc.to_bytes(2, "little")
