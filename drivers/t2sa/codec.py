"""Lines of T2SA, the text interface of SpatialAnalyzer (sheet `trackers_ballbar`, section 5). Pure.

A command is a line; each is answered by one line, `ACK-ddd text` or `ERR-ddd text`. Lines end in CR LF.
"""

import math
import re
from dataclasses import dataclass
from typing import Final

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.tracker import Place

LONGEST_BYTES: Final = 4096

BUSY: Final = 201
NO_SUCH_POINT: Final = 306
HIDDEN: Final = frozenset({305, 340})
"""A point, or a group of points, could not be measured."""

_REPLY: Final = re.compile(r"(ACK|ERR)-(\d{3})\s*(.*)", re.DOTALL)
_NUMBER: Final = r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)\s*"
_POINT: Final = re.compile(
    rf"Single Point Measurement (.+) result{_NUMBER},{_NUMBER},{_NUMBER}\b.*?(True|False)\s*", re.DOTALL
)
_REPORT: Final = re.compile(
    "Object Offset Report ([^;]*)"
    + "".join(f";{name}:{_NUMBER}" for name in ("X", "Y", "Z", "Rx", "Ry", "Rz"))
    + ";?.*",
    re.DOTALL,
)
_NAME: Final = re.compile(r"[^;:\x00-\x1f\x7f]+")


@dataclass(frozen=True)
class Reply:
    """The answer to a command.

    Attributes:
        ok: it was carried out.
        code: three digits.
        text: what follows.
    """

    ok: bool
    code: int
    text: str


@dataclass(frozen=True)
class Point:
    """A measured point.

    Attributes:
        name: of the point.
        place_mm: x, y, z.
        good: how the line ends.
    """

    name: str
    place_mm: Place
    good: bool


def encode(command: str) -> bytes:
    """Return a command as a line."""
    return command.encode("utf-8") + b"\r\n"


def is_name(text: str) -> bool:
    """Return whether a text can be the name of a point or a group within a command."""
    return _NAME.fullmatch(text) is not None


def parse_point(text: str) -> Point:
    """Return the point that an answer tells.

    Raises:
        ProtocolError: it tells none.
    """
    found = _POINT.fullmatch(text)
    if found is None:
        raise ProtocolError(f"{text[:80]!r} is no measured point")
    name, *values, good = found.groups()
    x, y, z = map(_finite, values)
    return Point(name.strip(), (x, y, z), good == "True")


def parse_report(text: str) -> tuple[Place, Place]:
    """Return place and rotations that an object offset report tells, in its units.

    Raises:
        ProtocolError: it is none.
    """
    found = _REPORT.fullmatch(text)
    if found is None:
        raise ProtocolError(f"{text[:80]!r} is no object offset report")
    x, y, z, rx, ry, rz = map(_finite, found.groups()[1:])
    return (x, y, z), (rx, ry, rz)


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ProtocolError(f"{text[:40]!r} is too large")
    return number


class ReplyDecoder:
    """Takes the line that answers one command."""

    may_end = False
    """Silence never ends a line."""

    def __init__(self) -> None:
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> Reply | None:
        """Take a chunk; return the answer when its line is complete.

        Raises:
            ProtocolError: no answer, or a line that does not end.
        """
        self._buffer += data
        line, end, rest = self._buffer.lstrip(b"\r\n").partition(b"\n")
        if end:
            self.rest, self._buffer = rest, b""
            return _parse(line)
        if len(self._buffer) > LONGEST_BYTES:
            raise ProtocolError(f"a line longer than {LONGEST_BYTES} bytes does not end")
        return None

    def end(self) -> Reply:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")


def _parse(line: bytes) -> Reply:
    try:
        found = _REPLY.fullmatch(line.decode("utf-8").strip())
    except UnicodeDecodeError:
        found = None
    if found is None:
        raise ProtocolError(f"{line[:80]!r} begins neither with ACK-ddd nor with ERR-ddd")
    return Reply(found[1] == "ACK", int(found[2]), found[3])
