r"""What a typed line means on a raw link: hex bytes, or text with escapes."""

import re
from typing import Final, Literal

LineEnd = Literal["cr", "lf", "crlf", "none"]

_ENDS: dict[LineEnd, bytes] = {"cr": b"\r", "lf": b"\n", "crlf": b"\r\n", "none": b""}
_ESCAPES = {"r": "\r", "n": "\n", "t": "\t", "e": "\x1b", "\\": "\\"}
_ESCAPE: Final = re.compile(r"\\(?:x(?P<code>[0-9A-Fa-f]{2})|(?P<letter>.)|$)")


def encoded(line: str, end: LineEnd, *, as_hex: bool) -> bytes:
    r"""Return the bytes that a line of input stands for.

    Args:
        line: hex digits, or text with the escapes \r \n \t \e \\ and \xNN.

    Raises:
        ValueError: it is neither; the text says what is wrong.
    """
    if as_hex:
        try:
            return bytes.fromhex(line) + _ENDS[end]
        except ValueError:
            raise ValueError(f"{line!r} is no row of hex bytes such as 31 3b 0d") from None
    try:
        return _ESCAPE.sub(_unescaped, line).encode("latin-1") + _ENDS[end]
    except UnicodeEncodeError as error:
        raise ValueError(f"{error.object[error.start]!r} is no single byte; write it as \\xNN") from None


def _unescaped(match: re.Match[str]) -> str:
    if match["code"]:
        return chr(int(match["code"], 16))
    if match["letter"] not in _ESCAPES:
        raise ValueError(f"{match[0]!r} is no escape; there are \\r \\n \\t \\e \\xNN and \\\\")
    return _ESCAPES[match["letter"]]
