"""Commands and replies of the Heidenhain ND displays. Pure.

A command is ESC, a letter, four digits, CR. A reply is STX and lines that end with CR LF, or ACK or NAK alone.
"""

import re

from catseye.drivers.roles.errors import ProtocolError

ACK = "ACK"
NAK = "NAK"

MAX_LINE_BYTES = 80

INDICATORS = ("REF", "DATUM1", "DATUM2", "SET", "START", "PRINT", "INCH")
"""The first indicators of the status bar, in their order; units differ in what follows."""

_DROPPED = b"\x02\x11\x13"
_POSITION = re.compile(r"([+-])\s*(\d{1,10})")
_DISPLAYED = re.compile(r"[+-]?\s*\d*([.,]?)(\d*)")


def command(text: str) -> bytes:
    """Return a command, such as A0200, as sent."""
    return b"\x1b" + text.encode("ascii") + b"\r"


class ReplyDecoder:
    """Takes the reply to one command."""

    may_end = False
    """Silence never ends a line."""

    def __init__(self, lines: int = 1) -> None:
        self._expected = lines
        self._lines: list[str] = []
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> tuple[str, ...] | None:
        """Take a chunk; return the lines when all are there, or ACK or NAK.

        Raises:
            ProtocolError: no text, or a line that does not end.
        """
        self._buffer += data.translate(None, _DROPPED)
        while match := re.search(rb"\r?\n|[\x06\x15]", self._buffer):
            line, end = self._buffer[: match.start()], match[0]
            self._buffer = self._buffer[match.end() :]
            if end in b"\x06\x15":
                return self._finished((ACK if end == b"\x06" else NAK,))
            self._lines.append(_text(line))
            if len(self._lines) == self._expected:
                return self._finished(tuple(self._lines))
        if len(self._buffer) > MAX_LINE_BYTES:
            raise ProtocolError(f"a line longer than {MAX_LINE_BYTES} bytes does not end")
        return None

    def end(self) -> tuple[str, ...]:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")

    def _finished(self, reply: tuple[str, ...]) -> tuple[str, ...]:
        self.rest, self._buffer = self._buffer, b""
        return reply


def _text(line: bytes) -> str:
    text = line.strip().decode("latin-1")
    if not text.isascii() or not text.isprintable():
        raise ProtocolError(f"{line[:32]!r} is not text")
    return text


def parse_position(text: str, decimals: int) -> float:
    """Read a position without decimal point, in the unit of the display.

    Args:
        text: sign and digits.
        decimals: digits behind the decimal point that is not sent.

    Raises:
        ProtocolError: it is no position.
    """
    match = _POSITION.fullmatch(text)
    if not match:
        raise ProtocolError(f"{text[:32]!r} is no sign and digits")
    return float(f"{match[1]}{match[2]}") / 10.0**decimals


def displayed_decimals(text: str) -> int | None:
    """Return the digits behind the decimal point of a displayed value; None when it is no value."""
    match = _DISPLAYED.fullmatch(text)
    if not match or not re.search(r"\d", text):
        return None
    return len(match[2]) if match[1] else 0


def parse_indicators(text: str) -> dict[str, bool]:
    """Read the status bar; an indicator that is on or blinks is true.

    Raises:
        ProtocolError: it is no status bar.
    """
    if not re.fullmatch(r"[012]{10,14}", text):
        raise ProtocolError(f"{text[:32]!r} is no status bar")
    return {name: digit != "0" for name, digit in zip(INDICATORS, text, strict=False)}
