"""Lines of a counter: cutting them out of the stream, reading numbers and bits. Pure."""

import math
import re

from catseye.drivers.counter.profile import CounterProfile, Scale, Status
from catseye.drivers.roles.errors import ProtocolError

MAX_LINE_BYTES = 1024
"""Far more than any known counter sends in a line."""

_SINGLE_BYTES = {b"\x06": b"ACK", b"\x15": b"NAK"}
_PIECES = re.compile(rb"[^\r\n\x06\x15]*(?:[\r\n]+|[\x06\x15])|[^\r\n\x06\x15]+")
_MM = {"nm": 1e-6, "um": 1e-3, "mm": 1.0, "inch": 25.4}
_UNIT_WORDS = {"nm": "nm", "um": "um", "µm": "um", "mm": "mm", "in": "inch", "inch": "inch"}


class LineDecoder:
    """Cuts one answer line out of the stream.

    CR, LF and CR LF end a line, empty lines are skipped. The control characters ACK and NAK, which come without
    line end, are answers named "ACK" and "NAK".

    Args:
        echo: the command that comes back first, empty when none does.
    """

    may_end = False
    """Silence never ends a line."""

    def __init__(self, profile: CounterProfile, echo: str = "") -> None:
        self._encoding = profile.line.encoding
        self._strip = bytes(profile.line.strip)
        self._echo = echo
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> str | None:
        """Take a chunk; return the line when it is complete.

        Raises:
            ProtocolError: not a line of text, or it does not end.
        """
        # Empty lines go in one go: a flood of them is not to hold the loop.
        self._buffer = (self._buffer + data.translate(None, self._strip)).lstrip(b"\r\n")
        while match := re.search(rb"[\r\n]|[\x06\x15]", self._buffer):
            line, end = self._buffer[: match.start()], match[0]
            self._buffer = self._buffer[match.end() :]
            text = self._text(line or _SINGLE_BYTES.get(end, b""))
            if text == self._echo:
                self._echo = ""
            elif text:
                self.rest, self._buffer = self._buffer, b""
                return text
        if len(self._buffer) > MAX_LINE_BYTES:
            raise ProtocolError(f"a line longer than {MAX_LINE_BYTES} bytes does not end")
        return None

    def end(self) -> str:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")

    def _text(self, line: bytes) -> str:
        try:
            text = line.decode(self._encoding).strip()
        except UnicodeDecodeError:
            raise ProtocolError(f"{line[:32]!r} is not a {self._encoding} text") from None
        if not text.isprintable():
            raise ProtocolError(f"control characters in {line[:32]!r}")
        return text


class QuietDecoder:
    """Takes whatever is answered until it is quiet; nothing at all is an answer, too."""

    may_end = True
    """Silence ends the answer."""

    rest = b""

    def feed(self, data: bytes) -> None:
        """Leave a chunk aside."""

    def end(self) -> bool:
        """Return True: a chunk that is left aside ends nothing."""
        return True


class StreamDecoder:
    """Cuts the lines of a stream; what is no text is left out.

    Attributes:
        discarded_lines: lines that were no text.
    """

    def __init__(self, profile: CounterProfile) -> None:
        self._profile = profile
        self._line = LineDecoder(profile)
        self.discarded_lines = 0

    def feed(self, data: bytes) -> list[str]:
        """Take a chunk; return the lines that are complete now."""
        lines: list[str] = []
        for piece in _PIECES.findall(data):
            try:
                text = self._line.feed(piece)
            except ProtocolError:
                # What is no text ends with its line; the next one is looked at anew.
                self._line = LineDecoder(self._profile)
                self.discarded_lines += 1
                continue
            if text:
                lines.append(text)
                self._line = LineDecoder(self._profile)
        return lines


def parse_value(reply: str, text: str) -> tuple[float, str]:
    """Read a number.

    Args:
        reply: regular expression with a group `value` and perhaps `unit`.

    Returns:
        The number and the unit as sent, empty if none.

    Raises:
        ProtocolError: the answer does not match, or is no finite number.
    """
    match = re.search(reply, text)
    if not match:
        raise ProtocolError(f"the answer {text[:64]!r} does not match {reply!r}")
    digits = re.sub(r"\s", "", match["value"] or "").replace(",", ".")
    try:
        value = float(digits)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ProtocolError(f"{digits!r} in the answer {text[:64]!r} is not a number")
    return value, match.groupdict().get("unit") or ""


def check_unit(word: str, scale: Scale) -> None:
    """Refuse a unit that is not the profile's: the length would be wrong by its factor.

    Raises:
        ProtocolError: another unit.
    """
    if word and _UNIT_WORDS.get(word.lower().replace("μ", "µ")) != scale.unit:
        raise ProtocolError(f"the instrument shows {word!r}, the profile says unit = {scale.unit!r}")


def length_mm(number: float, scale: Scale) -> float:
    """Return the length that a number means, growing with the beam, mm."""
    return scale.sign * number / 10.0**scale.decimals * (scale.count_mm or _MM[scale.unit])


def unwrap(count: int, last: int, bits: int) -> int:
    """Return the count nearest to the last one that equals it modulo 2**bits."""
    half = 1 << (bits - 1)
    return last + (count - last + half) % (2 * half) - half


def parse_bits(status: Status, text: str) -> dict[str, bool]:
    """Read the status bits; one that the instrument does not have is left out.

    Raises:
        ProtocolError: the answer does not match.
    """
    match = re.search(status.reply, text)
    try:
        word = int(match["bits"], status.radix) if match else -1
    except ValueError:
        word = -1
    if word < 0:
        raise ProtocolError(f"the answer {text[:64]!r} does not match {status.reply!r}")
    numbers = status.bits.model_dump(exclude_none=True)
    return {name: bool(word >> bit & 1) != (name in status.inverted) for name, bit in numbers.items()}
