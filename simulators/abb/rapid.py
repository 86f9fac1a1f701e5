"""RAPID data: texts of values, and the symbols of a task by name.

A num has 32 bits, as in RobotWare 6. A record is a list of its components.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

Value: TypeAlias = "bool | float | str | list[Value]"

UNUSED: Final = 9e9
"""An external axis that there is not."""

_LONGEST_TEXT: Final = 80
_TOKEN = re.compile(
    r'\s*(?:([\[\],])|(TRUE|FALSE)|"((?:[^"]|"")*)"|([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?))'
)


_LARGEST_NUM = float(np.finfo(np.float32).max)
"""Of a num, which has 32 bits."""


class ValueTextError(Exception):
    """A text is no value of the type."""


class UnknownSymbolError(Exception):
    """The task has no such symbol."""


class ReadOnlyError(Exception):
    """The symbol is no data that a client may write."""


def single(value: float) -> float:
    """Return a num: 32 bits."""
    return float(np.float32(value))


def value_text(value: Value) -> str:
    """Return a value as RAPID writes it."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, str):
        return '"' + value.replace('"', '""') + '"'
    if isinstance(value, list):
        return f"[{','.join(map(value_text, value))}]"
    return num_text(value)


def num_text(value: float) -> str:
    """Return a num with as many digits as tell it from every other."""
    short = np.float32(value)
    if short != 0.0 and not 1e-4 <= abs(short) < 1e7:
        return np.format_float_scientific(short, trim="-", exp_digits=2).upper()
    return np.format_float_positional(short, trim="-")


def parsed(text: str, like: Value) -> Value:
    """Read a value.

    Args:
        like: a value of its type.

    Raises:
        ValueTextError: the text is none.
    """
    value, end = _read(text, 0)
    if text[end:].strip() or not _is_like(value, like):
        raise ValueTextError
    return value


def _read(text: str, start: int) -> tuple[Value, int]:
    """Return the value that begins at a place of a text, and the place behind it."""
    found = _TOKEN.match(text, start)
    if found is None or found[1] in {"]", ","}:
        raise ValueTextError
    if found[1] == "[":
        return _read_list(text, found.end())
    if found[2]:
        return found[2] == "TRUE", found.end()
    if found[4]:
        value = float(found[4])
        if abs(value) > _LARGEST_NUM:
            raise ValueTextError
        return single(value), found.end()
    if len(found[3]) > _LONGEST_TEXT:
        raise ValueTextError
    return found[3].replace('""', '"'), found.end()


def _read_list(text: str, start: int) -> tuple[Value, int]:
    items: list[Value] = []
    while True:
        if len(items) > _LONGEST_TEXT or text.count("[", 0, start) > _LONGEST_TEXT:
            raise ValueTextError
        item, end = _read(text, start)
        items.append(item)
        found = _TOKEN.match(text, end)
        if found is None or found[1] not in {"]", ","}:
            raise ValueTextError
        start = found.end()
        if found[1] == "]":
            return items, start


def _is_like(value: Value, like: Value) -> bool:
    if isinstance(value, list) and isinstance(like, list):
        return len(value) == len(like) and all(map(_is_like, value, like))
    return type(value) is type(like)


@dataclass
class Symbol:
    """Persistent data of a module, or a procedure.

    Attributes:
        module: that declares it.
        kind: its type; empty for a procedure.
        read: returns its value; None for a procedure.
        write: takes a new value; None where it may not be written.
    """

    module: str
    kind: str
    read: Callable[[], Value] | None = None
    write: Callable[[Value], None] | None = None


class Symbols:
    """Symbols of one task; RAPID does not tell capitals from small letters.

    Args:
        task: its name.
    """

    def __init__(self, task: str) -> None:
        self._task = task
        self._known: dict[str, tuple[str, Symbol]] = {}

    def add(self, name: str, symbol: Symbol) -> None:
        """Let a symbol be known."""
        self._known[name.lower()] = (name, symbol)

    def named(self, url: str) -> Symbol:
        """Return a symbol by its place: RAPID/task/name or RAPID/task/module/name.

        Raises:
            UnknownSymbolError: there is none.
        """
        parts = url.split("/")
        name, symbol = self._known.get(parts[-1].lower(), ("", None))
        places = (["RAPID", self._task], ["RAPID", self._task, symbol.module if symbol else ""])
        if symbol is None or not name or parts[:-1] not in places:
            raise UnknownSymbolError
        return symbol

    def read(self, url: str) -> str:
        """Return the text of data.

        Raises:
            UnknownSymbolError: there is none.
        """
        read = self.named(url).read
        if read is None:
            raise UnknownSymbolError
        return value_text(read())

    def write(self, url: str, text: str) -> None:
        """Give data a value.

        Raises:
            UnknownSymbolError: there is none.
            ReadOnlyError: it may not be written.
            ValueTextError: the text is no value of its type.
        """
        symbol = self.named(url)
        if symbol.read is None or symbol.write is None:
            raise ReadOnlyError
        symbol.write(parsed(text, symbol.read()))

    def search(self, block: str, kind: str, pattern: str) -> list[tuple[str, Symbol]]:
        """Return places and symbols within a block.

        Args:
            block: RAPID, RAPID/task or RAPID/task/module.
            kind: per for data, prc for procedures, any for both.
            pattern: which the name has to match as a whole; empty for any.
        """
        found = [
            (f"RAPID/{self._task}/{symbol.module}/{name}", symbol) for name, symbol in self._known.values()
        ]
        return [
            (url, symbol)
            for url, symbol in found
            if f"{url}/".startswith(f"{block.strip('/')}/")
            and kind in {"any", "prc" if symbol.read is None else "per"}
            and (not pattern or _matches(pattern, url.rpartition("/")[2]))
        ]


def _matches(pattern: str, name: str) -> bool:
    # A client's own expression is not run: it may take for ever.
    return pattern.strip("^$").lower() in {name.lower(), ".*", ".+"}
