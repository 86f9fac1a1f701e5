"""What transcripts and texts must not hold: proofs of the password, and the keys of sessions."""

import re
from typing import Final

from catseye.drivers.roles.device import Entry, Sink

MASK: Final = b"***"
_NAMES: Final = (b"authorization:", b"cookie:", b"set-cookie:")
_LONGEST: Final = max(map(len, _NAMES))
_BEGINS, _PLAIN, _SECRET = "begins", "plain", "secret"
_PARTS = re.compile(rb"[^\n]*\n|[^\n]+")
_TOLD = re.compile(rb"(?:[A-Z]{3,7} \S{1,200} HTTP/1\.1|HTTP/1\.1 \d{3}[^\r\n]{0,60})")


def masked(sink: Sink) -> Sink:
    """Return a sink for one connection that hands on everything but the values of secret headers."""
    lines = {"tx": _Lines(), "rx": _Lines()}

    def show(entry: Entry, data: bytes) -> None:
        # What a link says of its healing holds no secrets.
        if told := data if entry == "heal" else lines[entry].masked(data):
            sink(entry, told)

    return show


def shown(data: bytes) -> str:
    """Return bytes for a text: the first line of a request or an answer, of others only how many they are."""
    found = _TOLD.match(data)
    return repr(found[0]) if found else f"{len(data)} bytes"


class _Lines:
    """Masks the lines of one direction, cut anywhere."""

    def __init__(self) -> None:
        self._held = b""
        self._state = _BEGINS

    def masked(self, data: bytes) -> bytes:
        """Return a chunk without secrets; a beginning of a line that may become one is kept for the next."""
        return b"".join(map(self._part, _PARTS.findall(data)))

    def _part(self, part: bytes) -> bytes:
        ended = part.endswith(b"\n")
        told = self._told(part, b"\r\n" if ended else b"")
        if ended:
            self._state = _BEGINS
        return told

    def _told(self, part: bytes, end: bytes) -> bytes:
        if self._state == _SECRET:
            return end
        if self._state == _PLAIN:
            return part
        line, self._held = self._held + part, b""
        begins = line[:_LONGEST].lower()
        if begins.startswith(_NAMES):
            self._state = _SECRET
            return line.partition(b":")[0] + b": " + MASK + end
        if not end and any(name.startswith(begins) for name in _NAMES):
            self._held = line
            return b""
        self._state = _PLAIN
        return line
