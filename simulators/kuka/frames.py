"""Frames of the proxy, seen from the controller: requests cut out of bytes, replies made.

`u16 tag | u16 length of the rest | u8 type | payload`, big-endian; a reply ends with `u16 error | u8 success`.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

_HEAD = struct.Struct(">HH")
_COUNT = struct.Struct(">H")
_FOOTER = struct.Struct(">HB")

LONGEST_BYTES = 0xFFFF
"""Most that a frame says of the length of its rest."""


class ErrorCode(IntEnum):
    """What the footer of a reply says."""

    GENERAL = 0
    SUCCESS = 1
    ACCESS = 2
    ARGUMENT = 3
    MEMORY = 4
    POINTER = 5
    UNEXPECTED = 6
    NOT_IMPLEMENTED = 7
    NO_INTERFACE = 8
    PROTOCOL = 9
    LONG_ANSWER = 10


@dataclass(frozen=True)
class Frame:
    """One request.

    Attributes:
        tag: number that the reply repeats.
        kind: what is asked for; None where the frame is too short to say it.
        payload: the rest.
    """

    tag: int
    kind: int | None
    payload: bytes


class FrameBuffer:
    """Cuts frames out of what a client sends.

    Args:
        forgets: what is left over of one piece is dropped when the next one comes, as a KUKAVARPROXY of old does:
            bytes behind a request do no harm there, and a request in two pieces is lost.
    """

    def __init__(self, *, forgets: bool = False) -> None:
        self._bytes = bytearray()
        self._forgets = forgets

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data
        if self._forgets:
            del self._bytes[self._end_of_frames() :]

    def _end_of_frames(self) -> int:
        end = 0
        while len(self._bytes) >= end + _HEAD.size:
            _, length = _HEAD.unpack_from(self._bytes, end)
            if len(self._bytes) < end + _HEAD.size + length:
                break
            end += _HEAD.size + length
        return end

    def take(self) -> Frame | None:
        """Return the next whole frame, None before it has come."""
        if len(self._bytes) < _HEAD.size:
            return None
        tag, length = _HEAD.unpack_from(self._bytes)
        end = _HEAD.size + length
        if len(self._bytes) < end:
            return None
        body = bytes(self._bytes[_HEAD.size : end])
        del self._bytes[:end]
        return Frame(tag, body[0] if body else None, body[1:])


class PayloadError(Exception):
    """A payload ends before what it announces."""


class PayloadReader:
    """Reads texts and counts out of a payload, in order."""

    def __init__(self, payload: bytes) -> None:
        self._rest = payload

    def byte(self) -> int:
        """Return the next byte.

        Raises:
            PayloadError: there is none.
        """
        return self._bytes(1)[0]

    def ascii(self) -> str:
        """Return the next text of single bytes; see `byte` for the error."""
        return self._bytes(self._count()).decode("latin-1")

    def ascii_or_rest(self) -> str:
        """Return the next text of single bytes, or what there is of it."""
        count = int.from_bytes(self._rest[: _COUNT.size], "big")
        text, self._rest = self._rest[_COUNT.size : _COUNT.size + count], self._rest[_COUNT.size + count :]
        return text.decode("latin-1")

    def utf16(self) -> str:
        """Return the next text of UTF-16LE, whose length counts characters; see `byte` for the error."""
        return self._bytes(2 * self._count()).decode("utf-16-le", errors="replace")

    def _count(self) -> int:
        return int(_COUNT.unpack(self._bytes(_COUNT.size))[0])

    def _bytes(self, count: int) -> bytes:
        if len(self._rest) < count:
            raise PayloadError
        taken, self._rest = self._rest[:count], self._rest[count:]
        return taken


def ascii_text(text: str) -> bytes:
    """Return a text of single bytes behind its length."""
    return _COUNT.pack(len(text)) + text.encode("latin-1", errors="replace")


def utf16_text(text: str) -> bytes:
    """Return a text of UTF-16LE behind its length in characters."""
    data = text.encode("utf-16-le")
    return _COUNT.pack(len(data) // 2) + data


def old_reply(request: Frame, payload: bytes, *, success: bool) -> bytes:
    """Return the reply of a KUKAVARPROXY of old, whose footer has the length of the success byte for an error.

    A payload that no frame holds is left out.
    """
    kind, footer = bytes([request.kind or 0]), _FOOTER.pack(1, success)
    fits = len(kind) + len(payload) + len(footer) <= LONGEST_BYTES
    body = kind + (payload if fits else ascii_text("")) + footer
    return _HEAD.pack(request.tag, len(body)) + body


def empty_reply(request: Frame) -> bytes:
    """Return what a KUKAVARPROXY of old says to a type that it does not know: its tag and nothing else."""
    return _HEAD.pack(request.tag, 0)


def reply(request: Frame, payload: bytes, error: ErrorCode) -> bytes:
    """Return the reply to a request."""
    kind = bytes([request.kind]) if request.kind is not None else b""
    body = kind + payload + _FOOTER.pack(error, error is ErrorCode.SUCCESS)
    return _HEAD.pack(request.tag, len(body)) + body
