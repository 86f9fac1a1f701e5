"""Numeric expressions and conditions of the language: + - * /, comparisons, AND, OR, NOT; true is 1, false is 0."""

import operator
import re
from collections.abc import Callable, Mapping

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.values import LARGEST, number

Lookup = Callable[[str, int | None], float]
"""Returns the value of a name, of M_IN and M_OUT with the number of their signal."""

_TOKEN = re.compile(r"\s*((?:\d+(?:\.\d*)?|\.\d+)(?:E[+-]?\d{1,2})?|[A-Z][A-Z0-9_]*|<>|<=|>=|[-+*/()<>=])")
_BINARY: tuple[Mapping[str, Callable[[float, float], float]], ...] = (
    {"OR": lambda a, b: float(bool(a) or bool(b))},
    {"AND": lambda a, b: float(bool(a) and bool(b))},
    {
        "=": lambda a, b: float(a == b),
        "<>": lambda a, b: float(a != b),
        "<": lambda a, b: float(a < b),
        ">": lambda a, b: float(a > b),
        "<=": lambda a, b: float(a <= b),
        ">=": lambda a, b: float(a >= b),
    },
    {"+": operator.add, "-": operator.sub},
    {"*": operator.mul, "/": operator.truediv},
)
"""Operators, those that bind least first."""


def evaluate(text: str, lookup: Lookup) -> float:
    """Return the value of an expression in capitals.

    Raises:
        Refusal: it is none, a name has no number, or the result is out of range.
    """
    return _Reader(_tokens(text), lookup).value()


def _tokens(text: str) -> list[str]:
    tokens, place, text = [], 0, text.rstrip()
    while place < len(text):
        found = _TOKEN.match(text, place)
        if found is None:
            raise Refusal(alarms.SYNTAX)
        tokens.append(found[1])
        place = found.end()
    return tokens


class _Reader:
    """Reads tokens from the left."""

    def __init__(self, tokens: list[str], lookup: Lookup) -> None:
        self._tokens = tokens[::-1]
        self._lookup = lookup

    def value(self) -> float:
        result = self._operation(0)
        if self._tokens:
            raise Refusal(alarms.SYNTAX)
        if abs(result) > LARGEST:
            raise Refusal(alarms.OUT_OF_RANGE)
        return result

    def _operation(self, rank: int) -> float:
        if rank == len(_BINARY):
            return self._single()
        result = self._operation(rank + 1)
        while self._next in _BINARY[rank]:
            combine = _BINARY[rank][self._tokens.pop()]
            try:
                result = combine(result, self._operation(rank + 1))
            except (ZeroDivisionError, OverflowError):
                raise Refusal(alarms.OUT_OF_RANGE) from None
        return result

    def _single(self) -> float:
        token = self._next
        if not token:
            raise Refusal(alarms.SYNTAX)
        self._tokens.pop()
        if token in {"-", "+", "NOT"}:
            value = self._single()
            return {"-": -value, "+": value, "NOT": float(not value)}[token]
        if token == "(":
            return self._bracketed()
        if token[0].isalpha():
            return self._lookup(token, self._index())
        return number(token)

    def _index(self) -> int | None:
        if self._next != "(":
            return None
        self._tokens.pop()
        return int(self._bracketed())

    def _bracketed(self) -> float:
        result = self._operation(0)
        if self._next != ")":
            raise Refusal(alarms.SYNTAX)
        self._tokens.pop()
        return result

    @property
    def _next(self) -> str:
        return self._tokens[-1] if self._tokens else ""
