"""How a program goes on from line to line: labels, GOTO, GOSUB, IF, FOR, WAIT, HLT, END (sheet, section 4.2).

Files and real-time control are in `catseye.simulators.melfa.open_files`; all else are statements of
`catseye.simulators.melfa.statements`. WHILE, SELECT, interrupts and functions are not interpreted. No source gives
alarms for jumps: 4340 for a missing label or line, 4220 for NEXT and RETURN without their beginning, 3120 for too
many levels are assumed.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from catseye.simulators.melfa import alarms, statements
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl, Run
from catseye.simulators.melfa.open_files import WORDS, Begin, OpenFiles

_LEVELS = 32
_ENDINGS = {"IF": "ENDIF", "FOR": "NEXT"}
"""What ends a block, by what begins it."""

_MOTIONS = frozenset({"MOV", "MVS", "MVR", "MVC"})

_COMMENT = re.compile(r"""((?:[^'"]|"[^"]*"?)*)'.*""")
_LABEL = re.compile(r"\*([A-Z][A-Z0-9_]*)\s*(?::\s*(.*))?")
_JUMP = re.compile(r"(GOTO|GOSUB)\s*(\*\s*[A-Z][A-Z0-9_]*|\d+)")
_IF = re.compile(r"IF\b(.+?)\b(?:THEN\b\s*(.*)|(GOTO\b.*))")
_FOR = re.compile(r"FOR\s+(M[A-Z0-9_]*)\s*=(.+?)\bTO\b(.+?)(?:\bSTEP\b(.+))?")
_BLOCK_IF = re.compile(r"IF\b.+\bTHEN")


@dataclass(frozen=True)
class _Loop:
    """A FOR that is being repeated: where it stands, its variable, end and step."""

    place: int
    name: str
    last: float
    step: float


@dataclass(frozen=True)
class Step:
    """What a line has done.

    Attributes:
        place: index of the line that is next; behind the last one the cycle is over.
        run: motion or delay to wait for before.
        begin: begins what has to be waited for before.
        halted: the program pauses before it.
    """

    place: int
    run: Run | None = None
    begin: Begin | None = None
    halted: bool = False


class Flow:
    """Where loops and subroutines of the program will go on; forgotten when it begins at its top."""

    def __init__(self, controller: ArmControl) -> None:
        self.controller = controller
        self._loops: list[_Loop] = []
        self._returns: list[int] = []
        self._program = _Program({})
        self._files = OpenFiles(lambda: controller.real_time)

    def begin(self) -> None:
        """Forget loops and returns and close files: the program begins at its top."""
        self._loops.clear()
        self._returns.clear()
        self._files.close_all()

    def halt(self) -> None:
        """Let go of what a line has begun: the program stands."""
        self._files.halt()

    def motion_before(self, lines: Mapping[int, str], place: int) -> int | None:
        """Return the index of the last motion before a line, None when there is none."""
        self._look_at(lines)
        before = [here for here in range(place) if self._program.texts[here].split(" ")[0] in _MOTIONS]
        return before[-1] if before else None

    def carry_out(self, lines: Mapping[int, str], place: int) -> Step:
        """Carry out a line.

        Args:
            lines: the program, by line number.
            place: index of the line.

        Raises:
            Refusal: the line is not understood or cannot be carried out.
        """
        self._look_at(lines)
        return self._statement(self._program, place, self._program.texts[place])

    def _look_at(self, lines: Mapping[int, str]) -> None:
        if self._program.lines is not lines:
            # A saved program's lines are never changed, but replaced.
            self._program = _Program(lines)

    def _statement(self, program: "_Program", place: int, text: str) -> Step:
        word = text.split(maxsplit=1)[0] if text else ""
        if word in {"", "REM", "ENDIF"}:
            return Step(place + 1)
        if word == "END":
            return Step(len(program.texts))
        if word == "HLT":
            return Step(place + 1, halted=True)
        if word == "ELSE":
            return Step(program.end_of("IF", place) + 1)
        if word in WORDS:
            return Step(place + 1, begin=self._files.carry_out(text))
        if (found := _JUMP.fullmatch(text)) is not None:
            return self._jump(program, place, *found.groups())
        if word == "RETURN":
            _require_begun(self._returns)
            return Step(self._returns.pop())
        if (found := _IF.fullmatch(text)) is not None:
            return self._branch(program, place, found)
        if word == "WAIT":
            return Step(place + bool(self._value(text[4:])))
        if (loop := _FOR.fullmatch(text)) is not None:
            return self._repeat(program, place, loop)
        if word == "NEXT":
            return self._next(place)
        return Step(place + 1, statements.execute(self.controller, text))

    def _value(self, text: str) -> float:
        return statements.value_of(self.controller, text)

    def _jump(self, program: "_Program", place: int, word: str, target: str) -> Step:
        if word == "GOSUB":
            _require_level(self._returns)
            self._returns.append(place + 1)
        return Step(program.place_of(target))

    def _branch(self, program: "_Program", place: int, found: re.Match[str]) -> Step:
        holds = bool(self._value(found[1]))
        if found[2] == "":
            # Checks that there is an ENDIF, before anything is done.
            end = program.end_of("IF", place)
            return Step(place + 1 if holds else program.else_of(place, end) + 1)
        then, _, otherwise = (found[2] or found[3]).partition(" ELSE ")
        chosen = (then if holds else otherwise).strip()
        if chosen.startswith("*") or chosen.isdecimal():
            chosen = f"GOTO {chosen}"
        return self._statement(program, place, chosen)

    def _repeat(self, program: "_Program", place: int, found: re.Match[str]) -> Step:
        first, last, step = (self._value(text) for text in (found[2], found[3], found[4] or "1"))
        if step == 0.0:
            raise Refusal(alarms.OUT_OF_RANGE)
        behind = program.end_of("FOR", place) + 1
        statements.assign(self.controller, found[1], repr(first))
        while any(loop.place == place for loop in self._loops):
            # It was left by a jump: what began with it or after it is over.
            self._loops.pop()
        if (last - first) * step < 0.0:
            return Step(behind)
        _require_level(self._loops)
        self._loops.append(_Loop(place, found[1], last, step))
        return Step(place + 1)

    def _next(self, place: int) -> Step:
        _require_begun(self._loops)
        loop = self._loops[-1]
        value = self._value(loop.name) + loop.step
        statements.assign(self.controller, loop.name, repr(value))
        if (loop.last - value) * loop.step >= 0.0:
            return Step(loop.place + 1)
        self._loops.pop()
        return Step(place + 1)


class _Program:
    """The lines of a program: their statements in capitals, and where jumps lead."""

    def __init__(self, lines: Mapping[int, str]) -> None:
        self.lines = lines
        self._numbers = list(lines)
        bare = [_COMMENT.sub(r"\1", line).strip().upper() for line in lines.values()]
        found = [_LABEL.fullmatch(line) for line in bare]
        self._labels = {label[1]: place for place, label in enumerate(found) if label}
        self.texts = [
            (label[2] or "").strip() if label else line for line, label in zip(bare, found, strict=True)
        ]

    def place_of(self, target: str) -> int:
        """Return the index of the line with a label `*NAME` or a number."""
        if target.startswith("*"):
            place = self._labels.get(target[1:].strip())
        else:
            place = self._numbers.index(int(target)) if int(target) in self._numbers else None
        if place is None:
            raise Refusal(alarms.UNDEFINED)
        return place

    def end_of(self, kind: str, place: int) -> int:
        """Return the index of the ENDIF or NEXT that belongs to the IF, ELSE or FOR at a place."""
        return self._matching(kind, place, _ENDINGS[kind], len(self.texts))

    def else_of(self, place: int, end: int) -> int:
        """Return the index of the ELSE that belongs to the IF at a place, of its ENDIF if there is none."""
        try:
            return self._matching("IF", place, "ELSE", end)
        except Refusal:
            return end

    def _matching(self, kind: str, place: int, closing: str, end: int) -> int:
        depth, ending = 0, _ENDINGS[kind]
        for here in range(place + 1, end):
            text = self.texts[here]
            word = text.split(maxsplit=1)[0] if text else ""
            if word == closing and depth == 0:
                return here
            if word == ending:
                depth -= 1
            elif _BLOCK_IF.fullmatch(text) if kind == "IF" else word == "FOR":
                depth += 1
        raise Refusal(alarms.SYNTAX)


def _require_begun(levels: Sequence[object]) -> None:
    if not levels:
        raise Refusal(alarms.SYNTAX)


def _require_level(levels: Sequence[object]) -> None:
    if len(levels) >= _LEVELS:
        raise Refusal(alarms.COUNT)
