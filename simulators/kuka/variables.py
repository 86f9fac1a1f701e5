"""The controller's variables by name: read, write, with indices in [] and members behind a point."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from catseye.simulators.kuka.values import Structure, Value, ValueTextError, parsed, value_text

_NAME = re.compile(r"(\$?\w+)(?:\[([^\]]*)\])?((?:\.\w+)*)")
_INDEX = re.compile(r"\d{0,9}")


class UnknownVariableError(Exception):
    """The controller has no such variable."""


class WriteProtectedError(Exception):
    """The variable is only to be read."""


@dataclass(frozen=True)
class Variable:
    """One variable.

    Attributes:
        read: returns its value, or those of an array.
        write: takes a new value; None where it is write-protected.
    """

    read: Callable[[], Value | Sequence[Value]]
    write: Callable[[Value], None] | None = None


class Variables:
    """Variables by name, in capitals; KRL does not tell them from small letters."""

    def __init__(self) -> None:
        self._known: dict[str, Variable] = {}

    @property
    def names(self) -> frozenset[str]:
        """Names of all variables."""
        return frozenset(self._known)

    def add(
        self,
        name: str,
        read: Callable[[], Value | Sequence[Value]],
        write: Callable[[Value], None] | None = None,
    ) -> None:
        """Let a variable be known."""
        self._known[name] = Variable(read, write)

    def read(self, name: str) -> str:
        """Return the text of a variable's value.

        Raises:
            UnknownVariableError: there is none, or no such element or member.
        """
        variable, index, path = self._resolved(name)
        return value_text(_part(_element(variable, index), path))

    def write(self, name: str, text: str) -> str:
        """Give a variable a value; return its text as it is read back.

        Raises:
            UnknownVariableError: there is none, or no such element or member.
            WriteProtectedError: it is only to be read.
            ValueTextError: the text is no value of its type.
        """
        variable, index, path = self._resolved(name)
        if variable.write is None:
            raise WriteProtectedError
        old = _element(variable, index)
        new = parsed(text, _part(old, path))
        if path:
            if not isinstance(old, Structure) or not isinstance(new, int | float | Structure):
                raise ValueTextError
            new = old.with_part(path, new)
        variable.write(new)
        return self.read(name)

    def _resolved(self, name: str) -> tuple[Variable, str | None, list[str]]:
        found = _NAME.fullmatch(name.strip().upper())
        if found is None or found[1] not in self._known:
            raise UnknownVariableError
        index = None if found[2] is None else found[2].strip()
        if index is not None and not _INDEX.fullmatch(index):
            raise UnknownVariableError
        return self._known[found[1]], index, found[3].split(".")[1:]


def _element(variable: Variable, index: str | None) -> Value:
    """Return the value, or the element of an array; [] behind a name is that of a text as a whole."""
    value = variable.read()
    if isinstance(value, str) and index in {None, ""}:
        return value
    if isinstance(value, Sequence) and not isinstance(value, str):
        if not index or not 1 <= int(index) <= len(value):
            raise UnknownVariableError
        return value[int(index) - 1]
    if index is not None or isinstance(value, Sequence):
        raise UnknownVariableError
    return value


def _part(value: Value, path: Sequence[str]) -> Value:
    if not path:
        return value
    if not isinstance(value, Structure):
        raise UnknownVariableError
    try:
        return value.part(path)
    except LookupError:
        raise UnknownVariableError from None
