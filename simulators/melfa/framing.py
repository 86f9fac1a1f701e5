"""Requests from a byte stream (sheet, section 1.2): CR, LF, CR LF or a pause ends a request."""

import re

LONGEST_BYTES = 255
"""Largest request that a controller takes (sheet, section 1.1)."""

TOO_LONG = None
"""Stands for a request that is longer; its bytes are not kept."""

_END = re.compile(rb"[\r\n]")


class RequestBuffer:
    """Cuts requests out of what a client sends; keeps no more than it needs."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._complete: list[bytes | None] = []
        self._skipping = False

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data
        while found := _END.search(self._bytes):
            self._finish(bytes(self._bytes[: found.start()]))
            del self._bytes[: found.end()]
        if len(self._bytes) > LONGEST_BYTES:
            self._finish(bytes(self._bytes))
            self._bytes.clear()
            self._skipping = True

    def take(self) -> list[bytes | None]:
        """Return the complete requests that have come, TOO_LONG for one that is too long."""
        complete, self._complete = self._complete, []
        return complete

    @property
    def rest(self) -> bytes:
        """What has come of a request that no terminator ends yet."""
        return b"" if self._skipping else bytes(self._bytes)

    @property
    def waiting(self) -> bool:
        """Something has come that a pause would complete."""
        return bool(self._bytes) or self._skipping

    def end_request(self) -> None:
        """Take what has come as complete: the client paused, or the request cannot go on."""
        self._finish(bytes(self._bytes))
        self._bytes.clear()

    def _finish(self, request: bytes) -> None:
        if self._skipping:
            self._skipping = False
        elif len(request) > LONGEST_BYTES:
            self._complete.append(TOO_LONG)
        elif request:
            self._complete.append(request)
