"""Modbus TCP (MODBUS Messaging on TCP/IP): frames, function codes 1-8, 15, 16, 22, 23 and 43/14, exceptions 1-3."""

import struct
from collections.abc import Callable

from catseye.simulators.modbus.diagnostics import RESTART, Diagnostics
from catseye.simulators.modbus.exceptions import (
    ILLEGAL_ADDRESS,
    ILLEGAL_FUNCTION,
    ILLEGAL_VALUE,
    ModbusError,
)
from catseye.simulators.ports.session import Answer, Session

_HEADER = struct.Struct(">HHHB")
_LARGEST_PDU = 253
_LARGEST_FUNCTION = 0x7F
_IDENTIFICATION = 0x2B0E
_MASK_WRITE = 22


class Registers:
    """What a device keeps behind its addresses; what a subclass leaves out the device does not have.

    Attributes:
        identity: identification objects: 0 vendor, 1 product code, 2 version, …
        diagnostics: what function 8 is about; None: the device does not have it.
        lacks: functions that the device does not have.
    """

    identity: dict[int, str]
    diagnostics: Diagnostics | None = None
    lacks: frozenset[int] = frozenset({_MASK_WRITE})

    def exception_status(self) -> int:
        """Return the eight outputs of function 7."""
        raise ModbusError(ILLEGAL_FUNCTION)

    def diagnostic_register(self) -> int:
        """Return what function 8 gives out by its sub-function 2."""
        return 0

    def read_words(self, address: int, count: int) -> list[int]:
        """Return 16-bit registers."""
        raise _no_such(address, count)

    def write_words(self, address: int, words: list[int]) -> None:
        """Write 16-bit registers from an address on (functions 6 and 16)."""
        raise _no_such(address, words)

    def read_bits(self, address: int, count: int) -> list[bool]:
        """Return coils from an address on (function 1)."""
        raise _no_such(address, count)

    def read_inputs(self, address: int, count: int) -> list[bool]:
        """Return discrete inputs from an address on (function 2)."""
        raise _no_such(address, count)

    def write_bits(self, address: int, bits: list[bool]) -> None:
        """Write coils from an address on (functions 5 and 15)."""
        raise _no_such(address, bits)


def _no_such(*_: object) -> ModbusError:
    return ModbusError(ILLEGAL_ADDRESS)


class ModbusSession(Session):
    """Conversation with one client; the unit identifier is echoed and otherwise ignored.

    Args:
        note: called with each request.
    """

    def __init__(self, registers: Registers, note: Callable[[str], None]) -> None:
        self._registers = registers
        self._counted = registers.diagnostics or Diagnostics()
        self._note = note
        self._bytes = bytearray()
        self._broken = False

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere. After a header that is no Modbus nothing can be understood any more."""
        if not self._broken:
            self._bytes += data

    def answer(self) -> Answer | None:
        """Carry out the next complete request."""
        if self._broken or len(self._bytes) < _HEADER.size:
            return None
        transaction, protocol, length, unit = _HEADER.unpack_from(self._bytes)
        if protocol != 0 or not 2 <= length <= _LARGEST_PDU + 1:
            self._broken = True
            self._bytes.clear()
            self._counted.frame_errors += 1
            return None
        end = _HEADER.size - 1 + length
        if len(self._bytes) < end:
            return None
        pdu = bytes(self._bytes[_HEADER.size : end])
        del self._bytes[:end]
        self._note(pdu.hex(" "))
        self._counted.messages += 1
        reply = respond(self._registers, pdu)
        return _HEADER.pack(transaction, 0, len(reply) + 1, unit) + reply if reply else b""


def respond(registers: Registers, pdu: bytes, *, broadcast: bool = False) -> bytes:
    """Return the reply to one request, both without header; empty bytes: none.

    Args:
        broadcast: it is for all devices of a line; none of them replies.
    """
    counted = registers.diagnostics or Diagnostics()
    silent = broadcast or counted.listens_only
    counted.unanswered += silent
    if counted.listens_only and pdu != RESTART:
        return b""
    counted.processed += 1
    reply = _carried_out(registers, pdu)
    if silent:
        return b""
    counted.unanswered += not reply
    counted.exceptions += bool(reply) and reply[0] > _LARGEST_FUNCTION
    return reply


def _carried_out(registers: Registers, pdu: bytes) -> bytes:
    function = pdu[0]
    handler = _FUNCTIONS.get(function)
    try:
        if handler is None or function in registers.lacks:
            raise ModbusError(ILLEGAL_FUNCTION)
        body = handler(registers, pdu[1:])
        return pdu[:1] + body if body else b""
    except ModbusError as error:
        return bytes([function | 0x80, error.code])


def _unpack(layout: str, body: bytes) -> tuple[int, ...]:
    if len(body) != struct.calcsize(layout):
        raise ModbusError(ILLEGAL_VALUE)
    return struct.unpack(layout, body)


def _require_count(count: int, largest: int, address: int) -> None:
    if not 1 <= count <= largest:
        raise ModbusError(ILLEGAL_VALUE)
    if address + count > 0x10000:
        raise ModbusError(ILLEGAL_ADDRESS)


def _read_coils(registers: Registers, body: bytes) -> bytes:
    return _read_bits(registers.read_bits, body)


def _read_inputs(registers: Registers, body: bytes) -> bytes:
    return _read_bits(registers.read_inputs, body)


def _read_bits(read: Callable[[int, int], list[bool]], body: bytes) -> bytes:
    address, count = _unpack(">HH", body)
    _require_count(count, 2000, address)
    bits = read(address, count)
    packed = sum(1 << n for n, bit in enumerate(bits) if bit).to_bytes((count + 7) // 8, "little")
    return bytes([len(packed)]) + packed


def _read_words(registers: Registers, body: bytes) -> bytes:
    address, count = _unpack(">HH", body)
    _require_count(count, 125, address)
    return _words_reply(registers.read_words(address, count))


def _words_reply(words: list[int]) -> bytes:
    return struct.pack(f">B{len(words)}H", 2 * len(words), *words)


def _write_bit(registers: Registers, body: bytes) -> bytes:
    address, value = _unpack(">HH", body)
    if value not in {0x0000, 0xFF00}:
        raise ModbusError(ILLEGAL_VALUE)
    registers.write_bits(address, [value == 0xFF00])
    return body


def _write_word(registers: Registers, body: bytes) -> bytes:
    address, value = _unpack(">HH", body)
    registers.write_words(address, [value])
    return body


def _read_exception_status(registers: Registers, body: bytes) -> bytes:
    _unpack("", body)
    return bytes([registers.exception_status()])


def _diagnose(registers: Registers, body: bytes) -> bytes:
    if registers.diagnostics is None:
        raise ModbusError(ILLEGAL_FUNCTION)
    return registers.diagnostics.carry_out(body, registers.diagnostic_register())


def _write_many_bits(registers: Registers, body: bytes) -> bytes:
    address, count, size = _unpack(">HHB", body[:5])
    _require_count(count, 1968, address)
    if size != (count + 7) // 8 or len(body) != 5 + size:
        raise ModbusError(ILLEGAL_VALUE)
    packed = int.from_bytes(body[5:], "little")
    registers.write_bits(address, [bool(packed >> n & 1) for n in range(count)])
    return body[:4]


def _write_many_words(registers: Registers, body: bytes) -> bytes:
    address, count, size = _unpack(">HHB", body[:5])
    _require_count(count, 123, address)
    if size != 2 * count:
        raise ModbusError(ILLEGAL_VALUE)
    registers.write_words(address, list(_unpack(f">{count}H", body[5:])))
    return body[:4]


def _write_masked(registers: Registers, body: bytes) -> bytes:
    address, keep, change = _unpack(">HHH", body)
    (before,) = registers.read_words(address, 1)
    registers.write_words(address, [before & keep | change & ~keep & 0xFFFF])
    return body


def _write_and_read(registers: Registers, body: bytes) -> bytes:
    read_address, read_count = _unpack(">HH", body[:4])
    _require_count(read_count, 125, read_address)
    address, count, size = _unpack(">HHB", body[4:9])
    _require_count(count, 121, address)
    if size != 2 * count:
        raise ModbusError(ILLEGAL_VALUE)
    registers.write_words(address, list(_unpack(f">{count}H", body[9:])))
    return _words_reply(registers.read_words(read_address, read_count))


_LAST_BASIC, _LAST_REGULAR = 0x02, 0x7F
"""Objects of the identification."""


def _identify(registers: Registers, body: bytes) -> bytes:
    kind, access, first = _unpack(">BBB", body)
    if kind != _IDENTIFICATION & 0xFF:
        raise ModbusError(ILLEGAL_FUNCTION)
    if access not in {1, 2, 3, 4}:
        raise ModbusError(ILLEGAL_VALUE)
    # A stream that starts at an object that does not exist starts at the first one.
    first = first if first in registers.identity or access == 4 else 0
    last = {1: _LAST_BASIC, 2: _LAST_REGULAR}.get(access, 0xFF)
    basic = {key: text for key, text in registers.identity.items() if first <= key <= last}
    objects = {first: registers.identity[first]} if access == 4 and first in registers.identity else basic
    if not objects or (access == 4 and first not in registers.identity):
        raise ModbusError(ILLEGAL_ADDRESS)
    listed = b"".join(bytes([key, len(text)]) + text.encode("ascii") for key, text in objects.items())
    # Single objects can be asked for, too.
    conformity = 0x83 if max(registers.identity) > _LAST_REGULAR else 0x82
    return bytes([kind, access, conformity, 0x00, 0x00, len(objects)]) + listed


_FUNCTIONS: dict[int, Callable[[Registers, bytes], bytes]] = {
    1: _read_coils,
    2: _read_inputs,
    3: _read_words,
    4: _read_words,
    5: _write_bit,
    6: _write_word,
    7: _read_exception_status,
    8: _diagnose,
    15: _write_many_bits,
    16: _write_many_words,
    _MASK_WRITE: _write_masked,
    23: _write_and_read,
    _IDENTIFICATION >> 8: _identify,
}
