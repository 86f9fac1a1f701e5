"""Payloads that a technician asks for: variables, directory, log, signals, monitors. Pure.

Layouts are those of the sheet, sections 1.12 to 1.14. Where it gives none, values are handed on as they come.
"""

import math
import re
from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.text import DeviceText

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:E[+-]?\d{1,3})?", re.IGNORECASE)
_WHOLE = re.compile(r"[0-9]{1,18}")
_POSITION = re.compile(r"\((?P<values>[^()]*)\)(?:\s*\((?P<flags>[^()]*)\))?")
_DATE = re.compile(r"(\d\d)-(\d\d)-(\d\d)(\d\d):(\d\d):(\d\d)")
_HEX = re.compile(r"[0-9A-Fa-f]+")
_DIRECTORY_FIELDS = 11
_FIRST_DIRECTORY_FIELDS = 13
_LOG_FIELDS = 8
_CURRENTS_AN_AXIS = 3
_PULSES_AN_AXIS = 4
_STOP_SOURCES = {1: "teaching pendant", 2: "personal computer", 4: "I/O signal", 8: "operating panel"}
_EMERGENCY_SOURCES = {1: "I/O signal", 2: "operating panel", 4: "teaching pendant"}


@dataclass(frozen=True)
class PositionValue:
    """Value of a position variable.

    Attributes:
        coordinates: X, Y, Z mm, A, B, C deg, further axes.
        flags: posture and turns.
    """

    coordinates: tuple[float, ...]
    flags: tuple[int, ...]


Value = float | tuple[float, ...] | PositionValue | str
"""Of an M, J, P or C variable."""


@dataclass(frozen=True)
class ProgramEntry(DeviceText):
    """One program in the controller's directory.

    Attributes:
        name: with extension.
        changed: date and time on the controller's clock.
        lines: number of lines.
        positions: number of its position variables.
    """

    name: str
    size_bytes: int
    changed: str
    lines: int
    positions: int


@dataclass(frozen=True)
class LogEntry(DeviceText):
    """One line of the error log.

    Attributes:
        time: date and time on the controller's clock, such that the order of texts is that of times.
        text: the controller's own words.
        level: H, L or C.
        program: where it happened, may be empty.
        line: line of that program.
        detail: nine digits.
    """

    time: str
    number: int
    text: str
    level: str
    program: str
    line: str
    detail: str


@dataclass(frozen=True)
class StopSources:
    """Who keeps the robot from moving.

    Attributes:
        stop: sources of a STOP signal, in words.
        emergency: sources of an emergency stop, in words.
    """

    stop: tuple[str, ...]
    emergency: tuple[str, ...]


@dataclass(frozen=True)
class EncoderReading:
    """Encoder of one axis, pulses.

    Attributes:
        feedback: position from the encoder.
        within_turn: position within one turn.
        fdt: the third value of the sheet's list, which it does not explain.
        command: commanded position.
    """

    feedback: int
    within_turn: int
    fdt: int
    command: int


def parse_variable(payload: str, name: str) -> Value:
    """Read `name=value`.

    Raises:
        ProtocolError: another variable, or no value.
    """
    named, separator, text = payload.partition("=")
    if not separator or named.strip().upper() != name.upper():
        raise ProtocolError(f"VAL{name} was answered by {payload[:64]!r}, which is not that variable")
    if text.startswith('"'):
        return text.strip('"')
    if not text.startswith("("):
        return _number(text, name)
    found = _POSITION.fullmatch(text.strip())
    if not found:
        raise ProtocolError(f"{name} has the value {text[:64]!r}, which is none")
    values = tuple(_number(part, name) if part.strip() else 0.0 for part in found["values"].split(","))
    if found["flags"] is None:
        return values
    return PositionValue(values, tuple(int(_number(part, name)) for part in found["flags"].split(",")))


def value_text(value: Value) -> str:
    """Return a value as the controller reads it.

    Raises:
        ValueError: a number is not finite, or the value is text.
    """
    match value:
        case str():
            raise ValueError("text variables are not written")
        case PositionValue(coordinates, flags):
            return f"{_listed(coordinates)}({','.join(map(str, flags))})"
        case tuple():
            return _listed(value)
        case _:
            return _decimal(value)


def _listed(values: tuple[float, ...]) -> str:
    return f"({','.join(map(_decimal, values))})"


def _decimal(value: float) -> str:
    if not math.isfinite(value):
        raise ValueError(f"a variable's value must be finite, got {value}")
    # Never a negative zero, and never an exponent: no source says whether one is understood.
    return f"{round(value, 6) + 0.0:.6f}".rstrip("0").rstrip(".")


def parse_directory(payload: str) -> tuple[ProgramEntry, int]:
    """Read an answer to PDIRTOP or PDIR<n>.

    Returns:
        The program, and the number of programs; 0 in answers without it.

    Raises:
        ProtocolError: another layout.
    """
    fields = payload.split(";")
    if len(fields) not in {_DIRECTORY_FIELDS, _FIRST_DIRECTORY_FIELDS}:
        raise ProtocolError(f"PDIR was answered by {payload[:64]!r}, which is not its layout")
    name, size, changed = fields[:3]
    count = _whole(fields[3], "PDIR") if len(fields) == _FIRST_DIRECTORY_FIELDS else 0
    # Behind the empty field that follows the attributes.
    lines, positions = (_whole(field, "PDIR") for field in fields[-6:-4])
    return ProgramEntry(name, _whole(size, "PDIR"), parse_date(changed), lines, positions), count


def parse_log(payload: str) -> LogEntry | None:
    """Read one line of the error log; None beyond its end.

    Raises:
        ProtocolError: another layout.
    """
    if not payload:
        return None
    fields = payload.split(";")
    if len(fields) < _LOG_FIELDS:
        raise ProtocolError(f"ERRORLOG was answered by {payload[:64]!r}, which is not its layout")
    day, time, number, text, level, program, line, detail = fields[:_LOG_FIELDS]
    return LogEntry(f"20{day} {time}", _whole(number, "ERRORLOG"), text, level, program, line, detail)


def parse_stop_sources(payload: str) -> StopSources:
    """Read STPSIG.

    Raises:
        ProtocolError: another layout.
    """
    fields = payload.split(";")
    if len(fields) != 2 or not all(map(_HEX.fullmatch, fields)):
        raise ProtocolError(f"STPSIG was answered by {payload[:64]!r}, which is not two hexadecimal numbers")
    stop, emergency = (int(field, 16) for field in fields)
    return StopSources(_named(stop, _STOP_SOURCES), _named(emergency, _EMERGENCY_SOURCES))


def _named(bits: int, names: dict[int, str]) -> tuple[str, ...]:
    known = tuple(name for bit, name in names.items() if bits & bit)
    unknown = bits & ~sum(names)
    return (*known, f"unknown source {unknown:X}") if unknown else known


def parse_word(payload: str, what: str) -> int:
    """Read 16 signals, four hex digits.

    Raises:
        ProtocolError: another layout.
    """
    if len(payload) != 4 or not _HEX.fullmatch(payload):
        raise ProtocolError(f"{what} was answered by {payload[:64]!r}, which is not four hexadecimal digits")
    return int(payload, 16)


def parse_encoders(payload: str) -> tuple[EncoderReading, ...]:
    """Read SRVENC, four numbers for each axis.

    Raises:
        ProtocolError: another layout.
    """
    values = [int(value) for value in parse_values(payload, "SRVENC")]
    if not values or len(values) % _PULSES_AN_AXIS:
        raise ProtocolError(f"SRVENC has {len(values)} values, four are needed for each axis")
    return tuple(
        EncoderReading(*values[n : n + _PULSES_AN_AXIS]) for n in range(0, len(values), _PULSES_AN_AXIS)
    )


def parse_currents(payload: str) -> tuple[float, ...]:
    """Read the feedback of SRVCUR1, the first of three numbers for each axis.

    Raises:
        ProtocolError: another layout.
    """
    values = parse_values(payload, "SRVCUR1")
    if len(values) % _CURRENTS_AN_AXIS:
        raise ProtocolError(f"SRVCUR1 has {len(values)} values, three are needed for each axis")
    return values[::_CURRENTS_AN_AXIS]


def parse_values(payload: str, what: str) -> tuple[float, ...]:
    """Read numbers between semicolons.

    Raises:
        ProtocolError: one is none.
    """
    return tuple(_number(field, what) for field in payload.rstrip(";").split(";"))


def parse_parameter(payload: str, name: str) -> tuple[str, ...]:
    """Read the values of a parameter from `name;values;count`, as text.

    Raises:
        ProtocolError: another parameter or layout.
    """
    fields = payload.split(";")
    if len(fields) < 2 or fields[0].strip().upper() != name.upper():
        raise ProtocolError(f"PNR{name} was answered by {payload[:64]!r}, which is not that parameter")
    return tuple(value.strip() for value in fields[1].split(","))


def parse_date(text: str) -> str:
    """Return a date of the controller, `yy-mm-ddhh:mm:ss`, with a century and a blank.

    Raises:
        ProtocolError: it is none.
    """
    found = _DATE.fullmatch(text)
    if not found:
        raise ProtocolError(f"{text[:32]!r} is not a date and time of the controller")
    year, month, day, hour, minute, second = found.groups()
    return f"20{year}-{month}-{day} {hour}:{minute}:{second}"


def _number(text: str, what: str) -> float:
    stripped = text.strip()
    if not _NUMBER.fullmatch(stripped) or not math.isfinite(value := float(stripped)):
        raise ProtocolError(f"{what} has the value {text[:32]!r}, which is not a number")
    return value


def _whole(text: str, what: str) -> int:
    if not _WHOLE.fullmatch(text):
        raise ProtocolError(f"{what} has {text[:32]!r} where a whole number belongs")
    return int(text)
