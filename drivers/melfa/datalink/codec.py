r"""Records of the data link: `id,command,a,b,c,d` and a CR, both ways. Pure.

The sheet does not know how a controller prints numbers (section 4.3): blanks, signs, decimals and exponents are all
taken. What the commands mean stands in the program that the controller runs, `programs/CATSDL.prg`.
"""

import math
import re
from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.pose import Pose

ADD, DRIVE, FEEDBACK, FORGET, WHO, SPEED, FINISH = range(1, 8)
UNKNOWN, REFUSED = -1, -2

MAX_POINTS = 60
"""Via points that the program keeps."""

MAX_RECORD_BYTES = 256
"""Far more than six numbers in any notation."""

_FIELDS = 6
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[Ee][+-]?\d{1,3})?")
_LARGEST = 1e9


@dataclass(frozen=True)
class Record:
    """One answer.

    Attributes:
        number: that of the request.
        command: that of the request, or UNKNOWN or REFUSED.
        values: four numbers.
    """

    number: int
    command: int
    values: tuple[float, float, float, float]


def encode(number: int, command: int, values: tuple[float, ...] = ()) -> bytes:
    """Return the bytes of a request.

    Args:
        values: up to four; missing ones are 0.

    Raises:
        ValueError: a value is not finite.
    """
    if not all(map(math.isfinite, values)):
        raise ValueError(f"data link values must be finite numbers, got {values}")
    a, b, c, d = (*values, 0.0, 0.0, 0.0, 0.0)[:4]
    # A rounded zero never goes out as -0.0000.
    numbers = ",".join(f"{round(value, 4) + 0.0:.4f}" for value in (a, b, c, d))
    return f"{number},{command},{numbers}\r".encode("ascii")


def parse(line: bytes) -> Record:
    """Read one record.

    Raises:
        ProtocolError: it is not six numbers.
    """
    fields = [field.strip() for field in line.decode("latin-1").split(",")]
    if len(fields) != _FIELDS or not all(map(_NUMBER.fullmatch, fields)):
        raise ProtocolError(f"a record is six numbers, this one is {line[:64]!r}")
    number, command, a, b, c, d = (float(field) for field in fields)
    if not (number.is_integer() and command.is_integer()) or max(map(abs, (number, a, b, c, d))) > _LARGEST:
        raise ProtocolError(f"a record begins with two whole numbers, this one is {line[:64]!r}")
    return Record(int(number), int(command), (a, b, c, d))


def joints_of(record: Record) -> Pose:
    """Return the feedback in a record: J1 deg, J2 deg, J3 mm, J4 deg."""
    return record.values


class RecordDecoder:
    """Cuts one record out of the stream; CR ends it, a LF behind it is taken too."""

    may_end = False
    """Silence never ends a record."""

    def __init__(self) -> None:
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> Record | None:
        """Take a chunk; return the record when it is complete.

        Raises:
            ProtocolError: no record, or it does not end.
        """
        self._buffer = (self._buffer + data).lstrip(b"\r\n")
        line, end, rest = self._buffer.partition(b"\r")
        if end:
            self.rest = rest
            return parse(line)
        if len(self._buffer) > MAX_RECORD_BYTES:
            raise ProtocolError(f"a record longer than {MAX_RECORD_BYTES} bytes does not end")
        return None

    def end(self) -> Record:
        """Refuse: silence does not end a record.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a record without end")
