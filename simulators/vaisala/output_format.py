"""Output formats of the PTU300 (`FORM`): parsed once, then filled with each reading.

Understood: `x.y` (digits before and after the point), quantities, `U` and `Un` (unit, in n characters), "text",
`#r #n #t #nnn` (also with a backslash), `ADDR SN ERR OK STAT TIME DATE A3H`, checksums `CS2 CS4 CSX` of what stands
before them. A number's field is as wide as its digits, the point and the decimals; a unit is filled with spaces
behind it.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import xor

LONGEST_CHARACTERS = 200

DEFAULT = '"P=" 5.1 P " " U3 " T=" 3.1 T " " U2 " RH=" 3.1 RH " " U3 #r #n'

_TOKEN = re.compile(
    r'\s*(?:"(?P<text>[^"]*)"|[#\\](?P<code>\d{1,3}|[rntRNT])|(?P<places>\d{1,2}\.\d{1,2})'
    r"|(?P<word>[A-Za-z][A-Za-z0-9]*))"
)
_CODES = {"r": "\r", "n": "\n", "t": "\t"}
_CHECKS: dict[str, Callable[[bytes], str]] = {
    "CS2": lambda sent: f"{sum(sent) & 0xFF:02X}",
    "CS4": lambda sent: f"{sum(sent) & 0xFFFF:04X}",
    "CSX": lambda sent: f"{reduce(xor, sent, 0):02X}",
}
_FACTS = ("ADDR", "SN", "ERR", "OK", "STAT", "TIME", "DATE", "A3H")


@dataclass(frozen=True)
class Value:
    """A quantity to show; a value of None is shown as asterisks."""

    value: float | None
    unit: str


@dataclass(frozen=True)
class _Shown:
    """What is known while a line is being made."""

    values: Mapping[str, Value]
    facts: Mapping[str, str]


class Format:
    """An output format.

    Args:
        text: as after FORM.

    Raises:
        ValueError: it cannot be understood.
    """

    def __init__(self, text: str, quantities: frozenset[str]) -> None:
        if len(text) > LONGEST_CHARACTERS:
            raise ValueError("the format is too long")
        self.text = text
        self._parts: list[Callable[[_Shown, str], str]] = []
        self._places = (4, 2)
        self._unit_of = ""
        position, text = 0, text.rstrip()
        while position < len(text):
            found = _TOKEN.match(text, position)
            if found is None:
                raise ValueError(f"not understood: {text[position:]!r}")
            self._take(found, quantities)
            position = found.end()

    def fill(self, values: Mapping[str, Value], facts: Mapping[str, str]) -> str:
        """Return a line of output with its own line end.

        Args:
            values: quantities by name.
            facts: ADDR, SN and the others that are no quantities.
        """
        shown, line = _Shown(values, facts), ""
        for part in self._parts:
            line += part(shown, line)
        return line

    def _take(self, found: re.Match[str], quantities: frozenset[str]) -> None:
        match found.lastgroup:
            case "text":
                self._literal(found["text"])
            case "code":
                code = found["code"]
                self._literal(_CODES.get(code.lower()) or chr(int(code) & 0xFF))
            case "places":
                before, after = found["places"].split(".")
                self._places = (int(before), int(after))
            case _:
                self._word(found["word"], quantities)

    def _literal(self, text: str) -> None:
        self._parts.append(lambda _shown, _line: text)

    def _word(self, word: str, quantities: frozenset[str]) -> None:
        name = word.upper()
        known = {quantity.upper(): quantity for quantity in quantities}
        if name in known:
            self._number(known[name])
        elif name in _CHECKS:
            self._parts.append(lambda _shown, line: _CHECKS[name](line.encode("latin-1", "replace")))
        elif name in _FACTS:
            self._parts.append(lambda shown, _line: shown.facts.get(name, ""))
        elif re.fullmatch(r"U\d?", name):
            self._unit(int(name[1:] or 0))
        else:
            raise ValueError(f"unknown: {word}")

    def _number(self, quantity: str) -> None:
        before, after = self._places
        self._unit_of = quantity

        def part(shown: _Shown, _line: str) -> str:
            value = shown.values[quantity].value
            width = before + 1 + after
            return "*" * width if value is None else f"{value:{width}.{after}f}"

        self._parts.append(part)

    def _unit(self, width: int) -> None:
        quantity = self._unit_of
        if not quantity:
            raise ValueError("a unit has to follow its quantity")
        self._parts.append(
            lambda shown, _line: f"{shown.values[quantity].unit:{width or 1}}"[: width or None]
        )
