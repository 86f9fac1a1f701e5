"""Lines of the LD5: commands, answers, refusals. Pure: no socket, no clock."""

import re
from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError

IDENTITY, POSITION, STATUS, ZERO = "ID", "1TP", "1TS", "1ZR"

LONGEST_BYTES = 255
"""Length of the display's buffer."""

_POSITION = re.compile(r"[+-]\d{4}\.\d{6}")
_STATUS = re.compile(r"([01]),([01]),([01]),([01]),(\d{3})")


def encode(command: str) -> bytes:
    """Return a command as it is sent."""
    return f"{command}\r\n".encode("ascii")


class AnswerDecoder:
    """Takes the bytes of one answer, cut anywhere, and returns its line."""

    may_end = False
    """Only CR LF ends an answer, never silence."""

    def __init__(self) -> None:
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> str | None:
        """Take a chunk; return the line when it is complete.

        Raises:
            ProtocolError: the line is no ASCII text, or it does not end.
        """
        self._buffer += data
        line, end, self.rest = self._buffer.partition(b"\r\n")
        if len(line) > LONGEST_BYTES:
            raise ProtocolError(f"a line longer than {LONGEST_BYTES} bytes")
        if not end:
            return None
        try:
            return line.decode("ascii")
        except UnicodeDecodeError:
            raise ProtocolError(f"{line[:32]!r} is no ASCII text") from None

    def end(self) -> str:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")


@dataclass(frozen=True)
class Status:
    """Answer to 1TS.

    Attributes:
        beam: a beam returns now.
        lost: the beam was lost since the last zero.
        fast: the display could not follow since the last zero.
        ready: the laser is stable.
        signal_percent: level of the signal.
    """

    beam: bool
    lost: bool
    fast: bool
    ready: bool
    signal_percent: int


def value_of(command: str, line: str) -> str:
    """Return what follows the echo of the command in its answer.

    Raises:
        ProtocolError: it is the answer to something else.
    """
    if not line.startswith(command):
        raise ProtocolError(f"{line[:32]!r} is no answer to {command}")
    return line.removeprefix(command)


def parse_position_mm(value: str) -> float:
    """Return the displacement, mm.

    Raises:
        ProtocolError: it is none.
    """
    if not _POSITION.fullmatch(value):
        raise ProtocolError(f"{value[:32]!r} is no position")
    return float(value)


def parse_status(value: str) -> Status:
    """Return the state of beam and laser.

    Raises:
        ProtocolError: it is none.
    """
    match = _STATUS.fullmatch(value)
    if match is None:
        raise ProtocolError(f"{value[:32]!r} is no status")
    beam, lost, fast, ready = (flag == "1" for flag in match.groups()[:4])
    return Status(beam, lost, fast, ready, int(match[5]))
