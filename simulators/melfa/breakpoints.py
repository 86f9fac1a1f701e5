"""Breakpoints (sheet, section 1.9): a program pauses before it carries out their lines.

    BRKPTSET[=]<program>;<line>[;<0 for good | 1 for once>]
    BRKPTCLR[=]<program>[;<line, 0 for all>]

The kinds and the 0 are those of a public client; the sheet has the words alone.
"""

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Breakpoint:
    """One breakpoint.

    Attributes:
        program: name, without extension.
        line: number.
        once: it is gone when it has been reached.
    """

    program: str
    line: int
    once: bool


class Breakpoints:
    """All breakpoints of a controller."""

    def __init__(self) -> None:
        self._set: dict[tuple[str, int], Breakpoint] = {}

    def __iter__(self) -> Iterator[Breakpoint]:
        return iter(sorted(self._set.values(), key=lambda one: (one.program, one.line)))

    def put(self, one: Breakpoint) -> None:
        """Set one, in the place of one at the same line."""
        self._set[one.program, one.line] = one

    def clear(self, program: str, line: int) -> None:
        """Take one away, or with line 0 all of a program; one that is not there is no error."""
        for key in [key for key in self._set if key[0] == program and line in {0, key[1]}]:
            del self._set[key]

    def reached(self, program: str, line: int) -> bool:
        """Return whether the program pauses before this line."""
        found = self._set.get((program, line))
        if found is not None and found.once:
            del self._set[program, line]
        return found is not None
