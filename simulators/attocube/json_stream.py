"""Cuts JSON objects out of a stream without any terminator between them."""

LONGEST_BYTES = 65_536
DEEPEST = 32

_OPEN, _CLOSE = b"{[", b"}]"


class JsonCutter:
    """Finds where each object ends by its braces; what stands between objects is passed over.

    An object that is too long or too deep is given out as empty bytes, once, and nothing of it is kept.
    """

    def __init__(self) -> None:
        self._object = bytearray()
        self._depth = 0
        self._in_text = False
        self._escaped = False

    def feed(self, data: bytes) -> list[bytes]:
        """Take bytes, cut anywhere; return the objects that are complete."""
        objects: list[bytes] = []
        for byte in data:
            if not self._depth and byte != ord("{"):
                continue
            self._object.append(byte)
            self._step(byte)
            if not self._depth:
                objects.append(bytes(self._object))
                self._forget()
            elif len(self._object) > LONGEST_BYTES or self._depth > DEEPEST:
                objects.append(b"")
                self._forget()
        return objects

    def _step(self, byte: int) -> None:
        if self._in_text:
            if self._escaped:
                self._escaped = False
            elif byte == ord("\\"):
                self._escaped = True
            elif byte == ord('"'):
                self._in_text = False
        elif byte == ord('"'):
            self._in_text = True
        elif byte in _OPEN:
            self._depth += 1
        elif byte in _CLOSE:
            self._depth -= 1

    def _forget(self) -> None:
        self._object.clear()
        self._depth = 0
        self._in_text = self._escaped = False
