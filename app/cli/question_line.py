"""A question at the foot of a terminal, with a live value redrawn above the line where the answer is typed."""

import shutil

from catseye.app.cli.output import talk
from catseye.app.protocol.run_events import LiveData
from catseye.app.results.numbers import fixed, number
from catseye.app.service.questions import hint
from catseye.procedures.kit.context import Prompt

_INPUT = "> "
# What a technician can act on; more digits only flicker.
_DECIMALS = {"mm": 3, "mrad": 2, "deg": 3, "mdeg": 1, "µm": 1, "µm/10 min": 1, "": 2}


def live_text(live: LiveData) -> str:
    """Return a live value with its acceptance band as people read it."""
    band = f"[{_limit(live.low)} … {_limit(live.high)}]" if (live.low, live.high) != (None, None) else ""
    verdict = "" if not band else "ok" if live.accepted else "outside"
    value = f"{live.name} {_value_text(live.value, live.unit)} {live.unit}".rstrip()
    return "  ".join(part for part in (value, band, verdict, live.text) if part)


class QuestionLine:
    """Draws on stderr, which is a terminal."""

    def __init__(self) -> None:
        self._asked: Prompt | None = None
        self._above = False
        self._at_start = False

    @property
    def asked(self) -> Prompt | None:
        """The open question."""
        return self._asked

    def ask(self, prompt: Prompt) -> None:
        """Show a question and where to type."""
        self._asked = prompt
        _write(f"question {prompt.id}: {prompt.text}\n")
        self.again()

    def again(self) -> None:
        """Show once more what can be typed."""
        if self._asked is not None:
            self._above = self._at_start = False
            _write(f"({hint(self._asked)}) {_INPUT}")

    def show(self, text: str) -> None:
        """Redraw the live value above the line where the answer is typed; what is typed so far stays."""
        line = text[: max(20, shutil.get_terminal_size().columns - 1)]
        if self._above:
            _write(f"\x1b7\x1b[1A\r\x1b[K{line}\x1b8")
        elif self._asked is not None:
            _write(f"\r\x1b[K{line}\n({hint(self._asked)}) {_INPUT}")
            self._above, self._at_start = True, False

    def entered(self) -> None:
        """A line was typed: the cursor stands at the start of the next one."""
        self._at_start, self._above = True, False

    def leave(self) -> None:
        """Leave the lines, for other talk."""
        if self._asked is not None:
            _write("" if self._at_start else "\n")
            self._at_start, self._above = True, False

    def close(self) -> None:
        """The question is over."""
        self.leave()
        self._asked = None


def _value_text(value: float, unit: str) -> str:
    if unit not in _DECIMALS:
        return _limit(value)
    return number(value, fixed(_DECIMALS[unit]), minus="-")


def _limit(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"


def _write(text: str) -> None:
    talk(text, heard=True)
