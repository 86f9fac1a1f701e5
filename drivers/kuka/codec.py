"""Requests and replies of KUKAVARPROXY and C3 Bridge as bytes: no link, no clock.

The sheet is `kuka_abb_robodk`, section A1: `u16 tag | u16 length of the rest | u8 type | payload`,
big-endian; a reply's payload is followed by `u16 error | u8 success`. A KUKAVARPROXY of old writes the length of its
success byte, always 1, where C3 Bridge has the error (its source, basMain.bas): the success byte decides.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from catseye.drivers.roles.errors import ProtocolError

_HEAD = struct.Struct(">HH")
_COUNT = struct.Struct(">H")
_FOOTER = struct.Struct(">HB")
_LARGEST_TAG: Final = 0xFFFF
_LONGEST_TEXT: Final = 0x7FFF
_MOST_ITEMS: Final = 0xFF


class Kind(IntEnum):
    """Types of messages that the driver uses."""

    READ = 0
    WRITE = 1
    READ_WIDE = 4
    WRITE_WIDE = 5
    READ_MANY = 6
    WRITE_MANY = 7


_WIDE: Final = frozenset({Kind.READ_WIDE, Kind.WRITE_WIDE, Kind.READ_MANY, Kind.WRITE_MANY})
_MANY: Final = frozenset({Kind.READ_MANY, Kind.WRITE_MANY})

SUCCESS: Final = 1
_GENERAL: Final = 0

ERRORS: Final = {
    0: "it failed; the proxy does not say why: the variable is unknown, write-protected, or the value is none of it",
    2: "access denied",
    3: "an argument is wrong: unknown variable, or a value that it does not take",
    4: "the proxy is out of memory",
    5: "the proxy met a wrong pointer",
    6: "something unexpected happened in the proxy",
    7: "the proxy does not know this type of message: it is older, or restricted",
    8: "the proxy has no interface to the controller: restart it, or the controller",
    9: "the proxy found the message malformed",
    10: "the answer would be too long",
}
"""What the error number of a reply means."""


@dataclass(frozen=True)
class Item:
    """One value of a reply.

    Attributes:
        error: number of its error, 1 for none.
        text: the value as the controller writes it; empty with an error.
    """

    error: int
    text: str


@dataclass(frozen=True)
class Reply:
    """A whole reply.

    Attributes:
        items: one value a variable that was asked for; fewer where the request failed as a whole.
        error: number of the error of the whole, 1 for none.
    """

    items: tuple[Item, ...]
    error: int


def encode_request(tag: int, kind: Kind, texts: Sequence[str]) -> bytes:
    """Return a request.

    Args:
        tag: number that the reply repeats, 0...65535.
        kind: what is asked for.
        texts: names, or names and values in turn, as the kind has them.

    Raises:
        ValueError: a number or a text does not fit into the message.
    """
    if not 0 <= tag <= _LARGEST_TAG:
        raise ValueError(f"a tag is 0...{_LARGEST_TAG}, got {tag}")
    payload = b"".join(_encoded(text, wide=kind in _WIDE) for text in texts)
    if kind in _MANY:
        payload = bytes([_item_count(kind, texts)]) + payload
    if 1 + len(payload) > _LARGEST_TAG:
        raise ValueError(f"{len(payload)} bytes do not fit into one message")
    return _HEAD.pack(tag, 1 + len(payload)) + bytes([kind]) + payload


def _item_count(kind: Kind, texts: Sequence[str]) -> int:
    count = len(texts) // (2 if kind is Kind.WRITE_MANY else 1)
    if count > _MOST_ITEMS:
        raise ValueError(f"one message has {_MOST_ITEMS} variables at most, got {count}")
    return count


def _encoded(text: str, *, wide: bool) -> bytes:
    data = text.encode("utf-16-le" if wide else "ascii")
    count = len(data) // 2 if wide else len(data)
    if count > _LONGEST_TEXT:
        raise ValueError(f"{text[:40]!r}… has {count} characters, more than {_LONGEST_TEXT}")
    return _COUNT.pack(count) + data


class ReplyDecoder:
    """Takes the bytes of the reply to one request.

    Args:
        tag: of the request.
        kind: of the request.
    """

    may_end: Final = False
    """A reply says how long it is; no silence ends it."""

    def __init__(self, tag: int, kind: Kind) -> None:
        self._tag = tag
        self._kind = kind
        self._bytes = b""
        self.rest = b""

    def feed(self, data: bytes) -> Reply | None:
        """Take a chunk; return the reply when it is complete.

        Raises:
            ProtocolError: this is no reply to that request.
        """
        self._bytes += data
        if len(self._bytes) < _HEAD.size:
            return None
        tag, length = _HEAD.unpack_from(self._bytes)
        if tag != self._tag:
            raise ProtocolError(f"the reply has the tag {tag}, expected {self._tag}")
        if length < 1 + _FOOTER.size:
            raise ProtocolError(f"a reply of {length} bytes is too short")
        end = _HEAD.size + length
        if len(self._bytes) > _HEAD.size and self._bytes[_HEAD.size] != self._kind:
            raise ProtocolError(
                f"the reply has the type {self._bytes[_HEAD.size]}, expected {int(self._kind)}"
            )
        if len(self._bytes) < end:
            return None
        self.rest = self._bytes[end:]
        return _decoded(self._kind, self._bytes[_HEAD.size + 1 : end])

    def end(self) -> Reply:
        """Refuse to end with a silence.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a reply is incomplete")


def _decoded(kind: Kind, body: bytes) -> Reply:
    payload, footer = body[: -_FOOTER.size], body[-_FOOTER.size :]
    error, success = _FOOTER.unpack(footer)
    if error == SUCCESS and success == 0:
        error = _GENERAL
    if success not in {0, 1} or (success == 1) != (error == SUCCESS):
        raise ProtocolError(
            f"the reply ends with error {error} and success {success}, which contradict each other"
        )
    items = _many(payload) if kind in _MANY else _one(payload, error, wide=kind in _WIDE)
    return Reply(items, error)


def _one(payload: bytes, error: int, *, wide: bool) -> tuple[Item, ...]:
    if not payload and error != SUCCESS:
        return ()
    text, rest = _text(payload, wide=wide)
    if rest:
        raise ProtocolError(f"{len(rest)} bytes follow the value of a reply")
    return (Item(error, text),)


def _many(payload: bytes) -> tuple[Item, ...]:
    if not payload:
        return ()
    items: list[Item] = []
    rest = payload[1:]
    for _ in range(payload[0]):
        if not rest:
            raise ProtocolError(f"a reply announces {payload[0]} values and has {len(items)}")
        error = rest[0]
        text, rest = _text(rest[1:], wide=True)
        items.append(Item(error, text))
    if rest:
        raise ProtocolError(f"{len(rest)} bytes follow the values of a reply")
    return tuple(items)


def _text(data: bytes, *, wide: bool) -> tuple[str, bytes]:
    """Return the text at the beginning of some bytes, and what follows it."""
    if len(data) < _COUNT.size:
        raise ProtocolError("a reply ends before the length of a value")
    (count,) = _COUNT.unpack_from(data)
    end = _COUNT.size + (2 * count if wide else count)
    if len(data) < end:
        raise ProtocolError(f"a value of {count} characters has {len(data) - _COUNT.size} bytes")
    try:
        text = data[_COUNT.size : end].decode("utf-16-le" if wide else "latin-1")
    except UnicodeDecodeError as exc:
        raise ProtocolError(f"a value is not text: {exc}") from None
    return text, data[end:]
