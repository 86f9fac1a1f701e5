"""Programs in the controller's memory, and the edit slot (sheet, section 1.14).

Lines are kept as they come: nothing checks their syntax but the execution. A line is 127 characters at most.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.values import Variable

EXTENSION = "MB6"
"""Of a program's file; the one that OPEN answers."""

TOTAL_BYTES = 262_144
"""Size of the memory; an assumption."""

LONGEST_LINE = 127
"""Characters in one line (sheet, section 4.1)."""

_NAME = re.compile(rf"([A-Z0-9_-]{{1,16}})(?:\.{EXTENSION})?")
_LARGEST_LINE_NUMBER = 32_767


@dataclass(frozen=True)
class Program:
    """One program.

    Attributes:
        lines: text of each line by its number, ascending.
        positions: position and joint variables that belong to it.
        attributes: p: lines are protected, q: variables are protected.
        changed_s: bench time of the last change, s.
        cycles: how often it was run through.
        last_s: bench time of the last cycle, s.
        total_s: bench time of all cycles, s.
    """

    lines: dict[int, str] = field(default_factory=dict)
    positions: dict[str, Variable] = field(default_factory=dict)
    attributes: frozenset[str] = frozenset()
    changed_s: float = 0.0
    cycles: int = 0
    last_s: float = 0.0
    total_s: float = 0.0

    @property
    def text(self) -> str:
        """The program as its file holds it."""
        return "".join(f"{number} {line}\r\n" for number, line in self.lines.items())

    @property
    def cycle_times(self) -> str:
        """All cycles, the latest one, their average, ms, and how many there were, as answers have them."""
        average_s = self.total_s / self.cycles if self.cycles else 0.0
        times = ";".join(f"{1e3 * time_s:.0f}" for time_s in (self.total_s, self.last_s, average_s))
        return f"{times};{self.cycles}"


class ProgramMemory:
    """All programs by name, without extension."""

    def __init__(self) -> None:
        self._programs: dict[str, Program] = {}

    @property
    def names(self) -> list[str]:
        """In alphabetical order, as the controller lists them."""
        return sorted(self._programs)

    @property
    def used_bytes(self) -> int:
        """What the programs take, a position counting as 64 bytes."""
        return sum(len(p.text) + 64 * (1 + len(p.positions)) for p in self._programs.values())

    def key(self, name: str) -> str:
        """Return a program's name without its extension.

        Raises:
            Refusal: no program can have such a name.
        """
        found = _NAME.fullmatch(name.strip().upper())
        if found is None:
            raise Refusal(alarms.FILE)
        return found[1]

    def has(self, name: str) -> bool:
        """Return whether there is such a program."""
        found = _NAME.fullmatch(name.strip().upper())
        return found is not None and found[1] in self._programs

    def find(self, name: str) -> Program:
        """Return a program by its name, in any case and with or without extension.

        Raises:
            Refusal: there is none of that name.
        """
        if not self.has(name):
            raise Refusal(alarms.NO_PROGRAM)
        return self._programs[self.key(name)]

    def put(self, name: str, program: Program) -> None:
        """Keep a program, in the place of one of the same name.

        Raises:
            Refusal: it is protected, the name is none, or the memory is full.
        """
        key = self.key(name)
        before = self._programs.get(key)
        if before is not None and "p" in before.attributes and program.lines != before.lines:
            raise Refusal(alarms.FILE)
        self._programs[key] = program
        if self.used_bytes > TOTAL_BYTES:
            self.remove(key)
            if before is not None:
                self._programs[key] = before
            raise Refusal(alarms.FILE)

    def remove(self, name: str) -> Program:
        """Take a program out."""
        program = self.find(name)
        del self._programs[self.key(name)]
        return program


class Editor:
    """The edit slot: one program is open, for one client.

    Args:
        time_s: returns the bench time, s.
    """

    def __init__(self, memory: ProgramMemory, time_s: Callable[[], float]) -> None:
        self._memory = memory
        self._time_s = time_s
        self._owner: object = None
        self.name = ""
        self._draft = Program()

    def open(self, name: str, owner: object) -> None:
        """Open a program, a new one if there is none of that name; what was open is thrown away."""
        self._check_owner(owner)
        key = self._memory.key(name)
        found = self._memory.find(key) if self._memory.has(key) else Program()
        self._draft = replace(found, lines=dict(found.lines), positions=dict(found.positions))
        self._owner, self.name = owner, key

    def draft(self, owner: object) -> Program:
        """Return what is being edited.

        Raises:
            Refusal: nothing is open, or another client edits.
        """
        self._check_owner(owner)
        if not self.name:
            raise Refusal(alarms.NOT_EDITING)
        return self._draft

    def save(self, owner: object) -> None:
        """Keep the draft and close it."""
        self._memory.put(self.name, replace(self.draft(owner), changed_s=self._time_s()))
        self.discard(owner)

    def discard(self, owner: object) -> None:
        """Close without keeping; a client that is gone closes too."""
        if self._owner is owner:
            self._owner, self.name = None, ""

    def write(self, owner: object, number: int, text: str) -> None:
        """Write a line in the place of what has its number."""
        draft = self.draft(owner)
        if not 1 <= number <= _LARGEST_LINE_NUMBER:
            raise Refusal(alarms.OUT_OF_RANGE, place=";1")
        if len(text) > LONGEST_LINE:
            raise Refusal(alarms.LINE_TOO_LONG, place=f";{LONGEST_LINE + 1}")
        self._require_room(draft, len(text))
        draft.lines[number] = text
        self.sort(draft, draft.lines)

    def declare(self, owner: object, name: str, value: Variable) -> None:
        """Write a position or joint variable."""
        draft = self.draft(owner)
        self._require_room(draft, 64)
        draft.positions[name] = value

    def sort(self, draft: Program, lines: dict[int, str]) -> None:
        """Take lines as those of the draft, in the order of their numbers."""
        ordered = sorted(lines.items())
        draft.lines.clear()
        draft.lines.update(ordered)

    def _check_owner(self, owner: object) -> None:
        if self._owner is not None and self._owner is not owner:
            raise Refusal(alarms.NO_EDIT_RIGHT)

    def _require_room(self, draft: Program, size: int) -> None:
        # An open draft takes as much as the memory may hold, not more.
        if len(draft.text) + 64 * len(draft.positions) + size > TOTAL_BYTES:
            raise Refusal(alarms.FILE)
