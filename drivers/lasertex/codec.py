"""Frames of the Lasertex HPI-3D: cutting them out of the stream, reading what they hold. Pure.

Commands are 8 bytes, frames 16: AA, a code of two bytes, data, a CRC over all before it.
"""

from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError

START = 0xAA
FRAME_BYTES = 16

DISTANCE_ON = 0xB032
STOP_STREAMS = 0xB03C
CLEAR_SMALL_SIGNAL = 0xB03D
CLEAR_OVERSPEED = 0xB03F
ZERO = 0xB048

DISTANCE = 0xB015

MM_PER_COUNT = 1e-7
_POLYNOMIAL = 0x31


def _crc_table() -> bytes:
    table = bytearray()
    for byte in range(256):
        for _ in range(8):
            byte = byte << 1 ^ _POLYNOMIAL if byte & 0x80 else byte << 1
        table.append(byte & 0xFF)
    return bytes(table)


_CRC_TABLE = _crc_table()


def crc8(data: bytes | bytearray) -> int:
    """Return the CRC-8: polynomial 0x31, start 0xFF, most significant bit first."""
    crc = 0xFF
    for byte in data:
        crc = _CRC_TABLE[crc ^ byte]
    return crc


def command(code: int) -> bytes:
    """Return a command without data."""
    head = bytes((START, code >> 8, code & 0xFF, 0, 0, 0, 0))
    return head + bytes((crc8(head),))


@dataclass(frozen=True)
class Frame:
    """What the instrument sends.

    Attributes:
        code: what it is; an acknowledgement has the code of its command.
        data: 12 bytes.
    """

    code: int
    data: bytes


class FrameDecoder:
    """Cuts frames out of a stream; after a fault it goes on at the next byte with which a frame can begin.

    Attributes:
        discarded_bytes: bytes that were in no frame.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self.discarded_bytes = 0

    def feed(self, data: bytes) -> list[Frame]:
        """Take a chunk; return the frames that are complete now."""
        self._buffer += data
        frames: list[Frame] = []
        while self._find_start() and len(self._buffer) >= FRAME_BYTES:
            if crc8(self._buffer[: FRAME_BYTES - 1]) == self._buffer[FRAME_BYTES - 1]:
                code = int.from_bytes(self._buffer[1:3], "big")
                frames.append(Frame(code, bytes(self._buffer[3 : FRAME_BYTES - 1])))
                del self._buffer[:FRAME_BYTES]
            else:
                self._discard(1)
        return frames

    def _find_start(self) -> bool:
        start = self._buffer.find(START)
        self._discard(len(self._buffer) if start < 0 else start)
        return start >= 0

    def _discard(self, count: int) -> None:
        del self._buffer[:count]
        self.discarded_bytes += count


@dataclass(frozen=True)
class Distance:
    """A distance frame.

    Attributes:
        count: length in steps of 100 pm.
        overspeed: the velocity was too high.
        laser_ready: the laser is stable.
        signal_ok: the signal is not too small.
        level: of the signal, 0...255; its unit is unknown.
    """

    count: int
    overspeed: bool
    laser_ready: bool
    signal_ok: bool
    level: int

    @property
    def length_mm(self) -> float:
        """The count as a length in mm, 0.1 nm each."""
        return self.count * MM_PER_COUNT


def parse_distance(frame: Frame) -> Distance:
    """Read a distance frame.

    Raises:
        ProtocolError: it is another frame.
    """
    if frame.code != DISTANCE:
        raise ProtocolError(f"frame {frame.code:04X} is not a distance")
    data = frame.data
    return Distance(
        count=int.from_bytes(data[:7], "big", signed=True),
        overspeed=bool(data[9] & 0x08),
        laser_ready=bool(data[10] & 0x01),
        signal_ok=bool(data[10] & 0x08),
        level=data[11],
    )
