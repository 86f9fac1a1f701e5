"""WebSocket as a server speaks it (RFC 6455): the handshake, text frames out, pings and an end in."""

import base64
import hashlib
from typing import Final

from catseye.simulators.abb.http import Answer, Request

PROTOCOL: Final = "robapi2_subscription"
_GUID: Final = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_TEXT, _CLOSE, _PING, _PONG = 0x1, 0x8, 0x9, 0xA
_LONGEST_BYTES: Final = 4096


def handshake(request: Request) -> Answer | None:
    """Return the answer to a request for a WebSocket; None where it is none."""
    key = request.headers.get("sec-websocket-key", "")
    if "websocket" not in request.headers.get("upgrade", "").lower() or not key:
        return None
    digest = hashlib.sha1((key + _GUID).encode(), usedforsecurity=False).digest()
    headers = [
        ("Upgrade", "websocket"),
        ("Connection", "Upgrade"),
        ("Sec-WebSocket-Accept", base64.b64encode(digest).decode()),
    ]
    if PROTOCOL in request.headers.get("sec-websocket-protocol", ""):
        headers.append(("Sec-WebSocket-Protocol", PROTOCOL))
    return Answer(101, headers=tuple(headers))


def text_frame(text: str) -> bytes:
    """Return a text in one frame."""
    return _frame(_TEXT, text.encode())


def _frame(kind: int, data: bytes) -> bytes:
    size = len(data)
    if size < 126:
        return bytes([0x80 | kind, size]) + data
    if size < 1 << 16:
        return bytes([0x80 | kind, 126]) + size.to_bytes(2) + data
    return bytes([0x80 | kind, 127]) + size.to_bytes(8) + data


class FrameReader:
    """Takes a client's frames.

    Attributes:
        ended: the client has closed, or said what is no frame.
    """

    def __init__(self) -> None:
        self.ended = False
        self._bytes = bytearray()

    def feed(self, data: bytes) -> bytes:
        """Take bytes, cut anywhere; return what is to be said to them."""
        self._bytes += data
        said = b""
        while not self.ended and (frame := self._next()) is not None:
            kind, content = frame
            self.ended = kind == _CLOSE
            if kind in {_CLOSE, _PING}:
                said += _frame(_CLOSE if kind == _CLOSE else _PONG, content)
        if self.ended:
            self._bytes.clear()
        return said

    def _next(self) -> tuple[int, bytes] | None:
        if len(self._bytes) < 2:
            return None
        size, start = self._bytes[1] & 0x7F, 2
        if size >= 126:
            start += 2 if size == 126 else 8
            size = int.from_bytes(self._bytes[2:start])
        if not self._bytes[1] & 0x80 or size > _LONGEST_BYTES:
            self.ended = True
            return None
        if len(self._bytes) < start + 4 + size:
            return None
        mask, start = self._bytes[start : start + 4], start + 4
        content = bytes(byte ^ mask[i % 4] for i, byte in enumerate(self._bytes[start : start + size]))
        kind = self._bytes[0] & 0x0F
        del self._bytes[: start + size]
        return kind, content
