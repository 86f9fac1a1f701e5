"""Values of KRL as texts of the controller: read, and written."""

import math
import re
from collections.abc import Iterable, Mapping
from typing import Final

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.pose import Pose

AXES: Final = ("A1", "A2", "A3", "A4", "A5", "A6")
"""Axes of the arm, in the order of a pose."""

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_STRUCTURE = re.compile(r"\{(?:\s*\w+\s*:)?([^{}]*)\}")
_SHOWN: Final = 80


def real_of(text: str) -> float:
    """Return an INT or REAL.

    Raises:
        ProtocolError: the text is no finite number.
    """
    # `float` strips less than `strip` does.
    digits = text.strip()
    if _NUMBER.fullmatch(digits) and math.isfinite(value := float(digits)):
        return value
    raise ProtocolError(f"{text[:_SHOWN]!r} is not a number")


def whole_of(text: str) -> int:
    """Return an INT.

    Raises:
        ProtocolError: the text is no whole number.
    """
    value = real_of(text)
    if value != int(value):
        raise ProtocolError(f"{text[:_SHOWN]!r} is not a whole number")
    return int(value)


def flag_of(text: str) -> bool:
    """Return a BOOL.

    Raises:
        ProtocolError: the text is none.
    """
    match text.strip().upper():
        case "TRUE":
            return True
        case "FALSE":
            return False
    raise ProtocolError(f"{text[:_SHOWN]!r} is neither TRUE nor FALSE")


def symbol_of(text: str) -> str:
    """Return the name of an enumeration's constant, in capitals.

    Raises:
        ProtocolError: the text is none.
    """
    name = text.strip().upper()
    if name[:1] != "#" or not name[1:].isidentifier():
        raise ProtocolError(f"{text[:_SHOWN]!r} is not a constant such as #P_ACTIVE")
    return name[1:]


def string_of(text: str) -> str:
    """Return a CHAR[], without the quotes that a controller may write around it."""
    return text.strip().strip('"').strip()


def members_of(text: str) -> dict[str, float]:
    """Return the members of a structure such as E6AXIS by name, in capitals.

    Raises:
        ProtocolError: the text is none.
    """
    found = _STRUCTURE.fullmatch(text.strip())
    if found is None:
        raise ProtocolError(f"{text[:_SHOWN]!r} is not a structure such as {{E6AXIS: A1 0.0, …}}")
    members: dict[str, float] = {}
    for part in found[1].split(","):
        name, _, value = part.strip().partition(" ")
        members[name.upper()] = real_of(value)
    return members


def axes_of(text: str) -> Pose:
    """Return the axes A1...A6 of an E6AXIS, deg.

    Raises:
        ProtocolError: one is missing, or the text is no structure.
    """
    members = members_of(text)
    try:
        return tuple(members[axis] for axis in AXES)
    except KeyError as exc:
        raise ProtocolError(f"axis {exc} is missing in {text[:_SHOWN]!r}") from None


def real_text(value: float) -> str:
    """Return a REAL as it is written: without exponent, finer than its 32 bits resolve."""
    return f"{value:.9f}"


def structure_text(members: Mapping[str, float] | Iterable[tuple[str, float]]) -> str:
    """Return a structure as it is written; members that it does not name keep their values."""
    return f"{{{','.join(f'{name} {real_text(value)}' for name, value in dict(members).items())}}}"
