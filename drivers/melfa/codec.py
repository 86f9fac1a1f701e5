"""R-protocol telegrams: requests, the boundary of answers, the layouts of their payloads. Pure.

Where an answer ends. A controller ends its answers with CR, with CR LF or, on TCP, with nothing at all; which
one is a parameter that a client cannot ask for. So:

* a terminator ends an answer, always;
* once a controller has been seen to use one, nothing else ends an answer;
* without one, an answer whose layout shows its end is complete there and then, and not before: the bare
  `QoK`, STATE (ends with the mechanism's digit), positions (end with eight hex digits), OPEN (ends with its
  16th semicolon), ERROR (ends with the level), a rejection with nine digits;
* every other answer (OVRD, PNR, a rejection with fewer digits) ends with the silence behind it. A number that
  the network splits with a longer pause than the quiet time (`QoK10`, pause, `0`) is then taken for complete,
  and cannot be known; the rest arrives unasked and makes the link heal itself.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError

MAX_REQUEST_BYTES = 255
"""Longest command (sheet 1.1)."""

MAX_ANSWER_BYTES = 4096
"""Longest answer that a known client makes room for (sheet 1.2)."""

_PREFIX = re.compile(r"Q(?:o(?P<ok>K)|e(?P<rejected>R))", re.IGNORECASE)
_PREFIX_BYTES = 3
_ANOTHER = re.compile(rb"Q(?:o[Kk]|e[Rr])")
_BEGINNINGS = frozenset(word[:n] for word in (b"qok", b"qer") for n in range(4))
_REJECTION = re.compile(r"(?P<number>\d{4})(?P<detail>\d{0,5})(?:;.*)?", re.DOTALL)
_REJECTION_DIGITS = 9
_SENDABLE = re.compile(r"[ -~\x0b]*")
"""Printable ASCII, and the vertical tab that a command may hold (sheet)."""

_CONTROL = re.compile(rb"[\x00-\x09\x0c\x0e-\x1f]")
"""No answer holds any of these; CR and LF end one, VT may stand in it."""

_STATE_END = re.compile(r";(?:REP|CYC);[A-Z]+;\d+;\d$")
_POSITIONS_END = re.compile(r";;[^;]*;[^;]*;[^;]*;[0-9A-Fa-f]{8}$")
_ERROR = re.compile(r"(?P<number>\d{1,4});(?P<level>[123])")
_FLAGS = re.compile(r"(?P<run>[0-9A-Fa-f]{2})(?P<stop>[0-9A-Fa-f]{2})(?P<error>\d{1,9})")
_NUMBER = re.compile(r"[+-]?\d+(?:\.\d*)?")
_STATE_FIELDS = 11
_OPEN_FIELDS = 13
_OPEN_SEMICOLONS = 16
_AXIS = re.compile(r"[A-Z]\d?")
_MIN_AXES, _MAX_AXES = 2, 8

Layout = Callable[[str], bool | None]
"""Judges a payload so far: True it is complete, False more must come, None it cannot be known."""


@dataclass(frozen=True)
class Answer:
    """One answer.

    Attributes:
        accepted: False when the controller rejected the request.
        alarm: the prefix flags an active alarm (`Qok`; sheet 1.6, likely).
        number: error number of a rejection, 0 otherwise.
        payload: text behind the prefix.
        terminated: a terminator ended it.
    """

    accepted: bool
    alarm: bool
    number: int
    payload: str
    terminated: bool


@dataclass(frozen=True)
class Opened:
    """Who answered OPEN (sheet 1.8).

    Attributes:
        joints: bit n set: joint n + 1 is there.
        model: robot type.
        controller: controller type.
        series: MELFA.
        firmware: version text.
        copyright: copyright text; an emulator says so here.
        serial: serial number, empty when not given.
    """

    joints: int
    model: str
    controller: str
    series: str
    firmware: str
    copyright: str
    serial: str


@dataclass(frozen=True)
class State:
    """Answer to STATE (sheet 1.10).

    Attributes:
        program: selected program, may be empty.
        override_percent: operation-panel override.
        run_bits: run status.
        stop_bits: stop status.
        error: alarm number, 0 when there is none.
    """

    program: str
    override_percent: float
    run_bits: int
    stop_bits: int
    error: int

    @property
    def machine_locked(self) -> bool:
        """Motions are carried out without the arm, and positions may say that it moved."""
        return bool(self.run_bits & 0x04)

    @property
    def teach_mode(self) -> bool:
        """The key is at TEACH."""
        return bool(self.run_bits & 0x08)

    @property
    def servo_on(self) -> bool:
        """Drives are powered."""
        return bool(self.run_bits & 0x20)

    @property
    def running(self) -> bool:
        """A motion or program is under way."""
        return bool(self.run_bits & 0x40)

    @property
    def operation_enabled(self) -> bool:
        """The operation right is taken."""
        return bool(self.run_bits & 0x80)

    @property
    def emergency_stop(self) -> bool:
        """The emergency stop circuit is open."""
        return bool(self.stop_bits & 0x01)


def encode(command: str, *, robot: int = 1, slot: int = 1, terminator: str = "\r") -> bytes:
    r"""Return the bytes of a request (sheet 1.5).

    Args:
        command: command word with its argument glued on.
        robot: 0...3.
        slot: -1...33.
        terminator: "\r", "\r\n" or "" for controllers that take a whole segment as a request.

    Raises:
        ValueError: the request is longer than 255 bytes, holds a control character or is not ASCII.
    """
    if not _SENDABLE.fullmatch(command):
        raise ValueError(f"R-protocol command {command!r}: only printable ASCII can be sent")
    data = f"{robot};{slot};{command}".encode("ascii")
    if len(data) > MAX_REQUEST_BYTES:
        raise ValueError(f"R-protocol command of {len(data)} bytes: at most {MAX_REQUEST_BYTES} are allowed")
    return data + terminator.encode("ascii")


def bare(payload: str) -> bool | None:
    """Layout of an answer without payload."""
    return True if not payload else None


def open_text(payload: str) -> bool | None:
    """Layout of the OPEN answer; other firmware may give other fields, so it may end before."""
    return True if payload.count(";") >= _OPEN_SEMICOLONS and payload.endswith(";") else None


def state_text(payload: str) -> bool | None:
    """Layout of the STATE answer."""
    return _STATE_END.search(payload) is not None


def positions_text(payload: str) -> bool | None:
    """Layout of JPOSF and PPOSF answers."""
    return _POSITIONS_END.search(payload) is not None


def error_text(payload: str) -> bool | None:
    """Layout of the ERROR answer."""
    return (_ERROR.fullmatch(payload) is not None) if payload else None


def free_text(payload: str) -> bool | None:  # noqa: ARG001  # a Layout by shape
    """Layout of answers that do not show their end."""
    return None


class AnswerDecoder:
    """Cuts one answer out of the stream.

    Args:
        layout: what the payload of an accepted answer looks like.
        terminated: the controller is known to end its answers with a terminator.
    """

    def __init__(self, layout: Layout, *, terminated: bool = False) -> None:
        self._layout = layout
        self._terminated = terminated
        self._buffer = b""
        self.rest = b""

    @property
    def may_end(self) -> bool:
        """Whether what has come so far is an answer if nothing follows at once."""
        return bool(self._buffer) and not self._terminated and self._verdict() is None

    def feed(self, data: bytes) -> Answer | None:
        """Take a chunk; return the answer when it is known to be complete.

        Raises:
            ProtocolError: no answer begins like this, or it does not end.
        """
        # A terminator that comes late stands before the next answer.
        self._buffer = (self._buffer + data).lstrip(b"\r\n")
        _check_beginning(self._buffer)
        line, end, rest = _split(self._buffer)
        if len(line) > MAX_ANSWER_BYTES:
            raise ProtocolError(f"an answer does not end within {MAX_ANSWER_BYTES} bytes")
        if end:
            self.rest = rest
            return parse_answer(line, terminated=True)
        if self._terminated:
            return None
        if another := _ANOTHER.search(self._buffer, _PREFIX_BYTES):
            # Two in one piece, as when a STOP is answered right behind the motion that it ended.
            whole, head = self._buffer, self._buffer[: another.start()]
            self._buffer = head
            if self._verdict() is not False:
                self.rest = whole[len(head) :]
                return self.end()
            self._buffer = whole
        return self.end() if self._verdict() else None

    def end(self) -> Answer:
        """Return the answer that has come so far.

        Raises:
            ProtocolError: the bytes are no answer.
        """
        return parse_answer(self._buffer, terminated=False)

    def _verdict(self) -> bool | None:
        text = self._buffer.decode("latin-1")
        if len(text) < _PREFIX_BYTES:
            return False
        payload = text[_PREFIX_BYTES:]
        if text[1] in "oO":
            return self._layout(payload)
        if _REJECTION.fullmatch(payload) is None:
            return False
        return True if len(payload) == _REJECTION_DIGITS and payload.isdecimal() else None


def _check_beginning(buffer: bytes) -> None:
    if buffer[:_PREFIX_BYTES].lower() not in _BEGINNINGS:
        raise ProtocolError(f"an answer begins with QoK or QeR, this one with {buffer[:32]!r}")
    if _CONTROL.search(buffer):
        raise ProtocolError(f"control characters in an answer: {buffer[:32]!r}")


def _split(buffer: bytes) -> tuple[bytes, bytes, bytes]:
    """Return the bytes before the first terminator, the terminator and the bytes behind it."""
    match = re.search(rb"\r\n?|\n", buffer)
    return (buffer[: match.start()], match[0], buffer[match.end() :]) if match else (buffer, b"", b"")


def parse_answer(data: bytes, *, terminated: bool) -> Answer:
    """Read a whole answer (sheet 1.6).

    Raises:
        ProtocolError: the bytes are no answer.
    """
    # OPEN may carry a copyright text outside of ASCII; latin-1 takes every byte.
    text = data.decode("latin-1")
    prefix = _PREFIX.match(text)
    if not prefix:
        raise ProtocolError(f"an answer begins with QoK or QeR, this one is {data[:32]!r}")
    payload = text[prefix.end() :]
    if prefix["ok"]:
        return Answer(
            accepted=True, alarm=prefix["ok"] == "k", number=0, payload=payload, terminated=terminated
        )
    rejection = _REJECTION.fullmatch(payload)
    if not rejection:
        raise ProtocolError(f"a rejection carries 4 to 9 digits, this one is {data[:32]!r}")
    number = int(rejection["number"])
    return Answer(accepted=False, alarm=True, number=number, payload=payload, terminated=terminated)


def parse_open(payload: str) -> Opened:
    """Read the OPEN answer (sheet 1.8).

    Raises:
        ProtocolError: fields are missing.
    """
    fields = payload.split(";")
    if len(fields) < _OPEN_FIELDS or not re.fullmatch(r"[0-9A-Fa-f]{1,4}", fields[1]):
        raise ProtocolError(f"OPEN was answered by {payload[:64]!r}, which is not the text of a controller")
    return Opened(
        joints=int(fields[1], 16),
        model=fields[6],
        controller=fields[7],
        series=fields[8],
        firmware=fields[10],
        copyright=fields[12],
        serial=fields[14] if len(fields) > 14 else "",
    )


def parse_state(payload: str) -> State:
    """Read the STATE answer, with eight or nine semicolons in its middle (sheet 1.10).

    Raises:
        ProtocolError: another layout.
    """
    fields = payload.split(";")
    flags = _FLAGS.fullmatch(fields[4]) if len(fields) >= _STATE_FIELDS else None
    if not flags or fields[-4] not in {"REP", "CYC"}:
        raise ProtocolError(f"STATE was answered by {payload[:64]!r}, which is not its layout")
    return State(
        program=fields[0],
        override_percent=parse_number(fields[2], "the override in STATE"),
        run_bits=int(flags["run"], 16),
        stop_bits=int(flags["stop"], 16),
        error=int(flags["error"]),
    )


def parse_positions(payload: str) -> dict[str, float]:
    """Read the pairs of a JPOSF or PPOSF answer, 2 to 8 of them (sheet 1.11).

    Returns:
        Axis names and values, deg or mm.

    Raises:
        ProtocolError: another layout.
    """
    fields = payload.split(";")
    count = fields.index("") if "" in fields else len(fields)
    names, values = fields[:count:2], fields[1:count:2]
    well_formed = not count % 2 and _MIN_AXES <= len(set(names)) == len(names) <= _MAX_AXES
    if not well_formed or not all(map(_AXIS.fullmatch, names)):
        raise ProtocolError(f"a position was answered by {payload[:64]!r}, which is not its layout")
    return {name: parse_number(value, name) for name, value in zip(names, values, strict=True)}


def parse_error(payload: str) -> tuple[int, int]:
    """Read the ERROR answer (sheet 1.13).

    Returns:
        Alarm number and level (1 H, 2 L, 3 C); both 0 when there is none.

    Raises:
        ProtocolError: another layout.
    """
    if not payload:
        return 0, 0
    match = _ERROR.fullmatch(payload)
    if not match:
        raise ProtocolError(f"ERROR was answered by {payload[:64]!r}, which is not number;level")
    return int(match["number"]), int(match["level"])


def parse_parameter(payload: str, name: str) -> tuple[float, ...]:
    """Read the values of a numeric parameter from a PNR answer, `name;values;count` (sheet 1.8, 1.14).

    Raises:
        ProtocolError: another parameter or layout.
    """
    fields = payload.split(";")
    if len(fields) < 2 or fields[0].strip() != name:
        raise ProtocolError(f"PNR{name} was answered by {payload[:64]!r}, which is not that parameter")
    return tuple(parse_number(value.strip(), name) for value in fields[1].split(","))


def parse_number(text: str, what: str) -> float:
    """Read a decimal number.

    Raises:
        ProtocolError: it is none.
    """
    if not _NUMBER.fullmatch(text) or not math.isfinite(value := float(text)):
        raise ProtocolError(f"{what} is {text!r}, which is not a number")
    return value
