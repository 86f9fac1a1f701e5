"""Values of KRL and their texts: INT, REAL, BOOL, CHAR[], enumerations and structures such as E6AXIS."""

import math
import re
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

AXES = tuple(f"A{number}" for number in range(1, 7))
EXTERNAL = tuple(f"E{number}" for number in range(1, 7))
PLACE = ("X", "Y", "Z")
ANGLES = ("A", "B", "C")

# No two parts of a pattern match the same text: what a client sends is as long as it likes, and read at once.
_INT = re.compile(r"[+-]?\d{1,10}")
_REAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
_NAMED = re.compile(r"\w+")
_LARGEST_INT = 2**31


class ValueTextError(Exception):
    """A text is no value of the type."""


@dataclass(frozen=True)
class Structure:
    """A value with members, all of them REAL but those named in `whole`, and structures without such of their own.

    Attributes:
        kind: name of its type.
        members: in order.
    """

    kind: str
    members: Mapping[str, "float | Structure"]
    whole: frozenset[str] = frozenset()

    def __str__(self) -> str:
        shown = (f"{name} {value_text(self.part([name]))}" for name in self.members)
        return f"{{{self.kind}: {', '.join(shown)}}}"

    def part(self, path: Sequence[str]) -> "int | float | Structure":
        """Return a member, or a member of it.

        Raises:
            LookupError: there is none.
        """
        name, *further = path
        value = self.members[name]
        if isinstance(value, Structure):
            return value.part(further) if further else value
        if further:
            raise LookupError(name)
        return int(value) if name in self.whole else float(value)

    def number(self, name: str) -> float:
        """Return a member that is a number.

        Raises:
            LookupError: there is none.
        """
        value = self.part([name])
        if isinstance(value, Structure):
            raise LookupError(name)
        return float(value)

    def with_part(self, path: Sequence[str], value: "float | Structure") -> "Structure":
        """Return it with another value of a member that there is."""
        name, *further = path
        old = self.members[name]
        if isinstance(old, Structure) and further:
            value = old.with_part(further, value)
        return replace(self, members={**self.members, name: value})

    def changed(self, text: str) -> "Structure":
        """Return it with the members that a text names; the others keep their values.

        Raises:
            ValueTextError: the text is no structure of this type.
        """
        members = dict(self.members)
        for part in _parts(_inside(text, self.kind)):
            name, *rest = part.split(maxsplit=1)
            if name.upper() not in members or not rest:
                raise ValueTextError
            old = members[name.upper()]
            new = old.changed(rest[0]) if isinstance(old, Structure) else real_of(rest[0].strip())
            members[name.upper()] = new
        return replace(self, members=members)


@dataclass(frozen=True)
class Symbol:
    """A constant of an enumeration.

    Attributes:
        name: without its #.
        known: constants of the enumeration.
    """

    name: str
    known: frozenset[str] = field(default_factory=frozenset)

    def __str__(self) -> str:
        return f"#{self.name}"


Value = bool | int | float | str | Structure | Symbol


def value_text(value: Value) -> str:
    """Return a value as the controller writes it."""
    match value:
        case bool():
            return "TRUE" if value else "FALSE"
        case float():
            return _real_text(value)
        case str():
            return f'"{value}"'
        case _:
            return str(value)


def parsed(text: str, old: Value) -> Value:
    """Return the value of a text, of the type of a value that it replaces.

    Raises:
        ValueTextError: the text is none of that type.
    """
    text = text.strip()
    match old:
        case bool():
            if text.upper() not in {"TRUE", "FALSE"}:
                raise ValueTextError
            return text.upper() == "TRUE"
        case int():
            return _int_of(text)
        case float():
            return real_of(text)
        case str():
            if len(text) < 2 or text[0] != '"' or text[-1] != '"':
                raise ValueTextError
            return text[1:-1]
        case Structure():
            return old.changed(text)
        case Symbol():
            if text[:1] != "#" or text[1:].upper() not in old.known:
                raise ValueTextError
            return replace(old, name=text[1:].upper())


def _inside(text: str, kind: str) -> str:
    """Return what stands in the braces of a structure, behind its type where it names one.

    Raises:
        ValueTextError: there are no braces, or the type is another one.
    """
    text = text.strip()
    if len(text) < 2 or text[0] != "{" or text[-1] != "}":
        raise ValueTextError
    named, colon, rest = text[1:-1].partition(":")
    if not colon or not _NAMED.fullmatch(named.strip()):
        return text[1:-1]
    if named.strip().upper() != kind:
        raise ValueTextError
    return rest


def _parts(inside: str) -> Iterator[str]:
    """Yield what stands between commas, those within inner braces left alone.

    Raises:
        ValueTextError: nothing stands between two of them, or braces do not fit.
    """
    depth = begin = 0
    for at, sign in enumerate(inside + ","):
        depth += (sign == "{") - (sign == "}")
        if depth < 0:
            raise ValueTextError
        if sign == "," and not depth:
            if not (part := inside[begin:at]).strip():
                raise ValueTextError
            yield part
            begin = at + 1
    if depth:
        raise ValueTextError


def single(value: float) -> float:
    """Return a number as a REAL of the controller keeps it: 32 bits."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


def real_of(text: str) -> float:
    """Return the REAL of a text.

    Raises:
        ValueTextError: the text is no number, or none that a REAL can be.
    """
    if not _REAL.fullmatch(text) or not math.isfinite(value := float(text)):
        raise ValueTextError
    try:
        return single(value)
    except OverflowError:
        raise ValueTextError from None


def _int_of(text: str) -> int:
    if not _INT.fullmatch(text) or not -_LARGEST_INT <= int(text) < _LARGEST_INT:
        raise ValueTextError
    return int(text)


def _real_text(value: float) -> str:
    """Return the shortest text that a REAL of 32 bits is read back from."""
    kept = single(value)
    if not math.isfinite(kept):
        return str(kept)
    digits = next(n for n in range(1, 10) if single(float(f"{kept:.{n}g}")) == kept)
    return repr(float(f"{kept:.{digits}g}"))


def e6axis(values: tuple[float, ...]) -> Structure:
    """Return joints as E6AXIS, deg; there are no external axes."""
    axes = dict(zip(AXES, map(single, values), strict=True))
    return Structure("E6AXIS", axes | dict.fromkeys(EXTERNAL, 0.0))


def frame(x: float = 0.0, y: float = 0.0, z: float = 0.0, *angles: float) -> Structure:
    """Return a FRAME, mm and deg."""
    a, b, c = angles or (0.0, 0.0, 0.0)
    values = map(single, (x, y, z, a, b, c))
    return Structure("FRAME", dict(zip((*PLACE, *ANGLES), values, strict=True)))


def e6pos(place: Structure, status: int, turn: int) -> Structure:
    """Return a FRAME as E6POS with status and turn; there are no external axes."""
    members = {**place.members, "S": float(status), "T": float(turn), **dict.fromkeys(EXTERNAL, 0.0)}
    return Structure("E6POS", members, frozenset({"S", "T"}))


def axis_inc(counts: Sequence[int]) -> Structure:
    """Return counts of the axes' encoders as AXIS_INC; there are no external axes."""
    members = dict(zip(AXES, map(float, counts), strict=True)) | dict.fromkeys(EXTERNAL, 0.0)
    return Structure("AXIS_INC", members, frozenset(members))


def load() -> Structure:
    """Return a LOAD of nothing: mass, kg, centre of mass and axes of inertia, mm and deg, and inertia, kg m²."""
    return Structure("LOAD", {"M": 0.0, "CM": frame(), "J": Structure("INERTIA", dict.fromkeys(PLACE, 0.0))})
