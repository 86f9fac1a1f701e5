"""Lines of Vaisala's ASCII interface (sheet of the air sensors, section 1b). Pure."""

import re
from dataclasses import dataclass

from catseye.drivers.roles.errors import ProtocolError

MAX_LINE_BYTES = 512
_LONGEST_NUMBER = 32

FORM = '"P=" 5.2 P " " U4 " T=" 4.2 T " " U2 " RH=" 4.2 RH " " U3 " " CS4 #r #n'
"""What the driver sets: all that it needs, with a checksum of what stands before it."""

_PER_HPA = {
    "hpa": 1.0,
    "mbar": 1.0,
    "kpa": 10.0,
    "pa": 0.01,
    "inhg": 33.863886,
    "mmhg": 1.3332239,
    "torr": 1.3332237,
    "bara": 1000.0,
    "psia": 68.947573,
    "mmh2o": 0.0980665,
    "inh2o": 2.4908891,
}
_VALUE = re.compile(
    r"\b(?P<name>[A-Za-z][A-Za-z0-9]*)\s*=\s*(?P<number>[+-]?\d+(?:\.\d+)?|\*+\.?\**)\s*(?P<unit>['%]?\w+)"
)
_CHECKED = re.compile(r"(?P<body>.* )(?P<check>[0-9A-F]{4})\s*")


class TextDecoder:
    """Cuts one answer line out of the stream. Empty lines, prompts and the echo of the command are skipped.

    Args:
        echo: the command, which may come back first.
    """

    may_end = False
    """Silence never ends a line."""

    def __init__(self, echo: str = "") -> None:
        self._echo = echo
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> str | None:
        """Take a chunk; return the line when it is complete.

        Raises:
            ProtocolError: it does not end, or is no text.
        """
        self._buffer += data
        while found := re.search(rb"[\r\n]", self._buffer):
            line, self._buffer = self._buffer[: found.start()], self._buffer[found.end() :]
            text = _text(line).lstrip(">")
            if text.strip() and text.strip() != self._echo:
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
        raise ProtocolError("the line has no end")


@dataclass(frozen=True)
class Values:
    """Contents of a line; None for a value of asterisks or one that is not there.

    Attributes:
        temperature_c: °C.
        pressure_hpa: hPa.
        humidity_percent: %RH.
    """

    temperature_c: float | None
    pressure_hpa: float | None
    humidity_percent: float | None


def parse_values(line: str) -> Values:
    """Read a line of values by their names and units, whatever their order.

    Raises:
        ProtocolError: no value is there, a unit is unknown, or a number has too many digits.
    """
    found = {match["name"].upper(): (match["number"], match["unit"]) for match in _VALUE.finditer(line)}
    if not found.keys() & {"P", "T", "RH"}:
        raise ProtocolError(f"{line[:64]!r} names none of P, T and RH with value and unit")
    return Values(
        temperature_c=_celsius(found.get("T")),
        pressure_hpa=_hpa(found.get("P")),
        humidity_percent=_percent(found.get("RH")),
    )


def checked(line: str) -> str:
    """Return a line of the driver's own format without its checksum.

    Raises:
        ProtocolError: the checksum is missing or wrong.
    """
    found = _CHECKED.fullmatch(line)
    if found is None or sum(found["body"].encode("latin-1")) & 0xFFFF != int(found["check"], 16):
        raise ProtocolError(f"{line[:64]!r} has no or a wrong checksum")
    return found["body"]


def _text(line: bytes) -> str:
    try:
        return line.decode("ascii")
    except UnicodeDecodeError:
        raise ProtocolError(
            f"{line[:64]!r} is not text: check baud, parity and bits (4800, E, 7 are usual)"
        ) from None


def _number(text: str) -> float | None:
    if len(text) > _LONGEST_NUMBER:
        raise ProtocolError(f"{text[:64]!r} is too long for a number")
    return None if "*" in text else float(text)


def _celsius(found: tuple[str, str] | None) -> float | None:
    if found is None or (value := _number(found[0])) is None:
        return None
    match found[1].lstrip("'").upper():
        case "C":
            return value
        case "F":
            return (value - 32.0) / 1.8
        case other:
            raise ProtocolError(f"the temperature has the unit {other!r}: set UNIT M")


def _hpa(found: tuple[str, str] | None) -> float | None:
    if found is None or (value := _number(found[0])) is None:
        return None
    factor = _PER_HPA.get(found[1].lower())
    if factor is None:
        raise ProtocolError(f"the pressure has the unit {found[1]!r}: set UNIT P hPa")
    return value * factor


def _percent(found: tuple[str, str] | None) -> float | None:
    if found is None or (value := _number(found[0])) is None:
        return None
    if found[1].upper() != "%RH":
        raise ProtocolError(f"the humidity has the unit {found[1]!r}: set the default format by FORM /")
    return value
