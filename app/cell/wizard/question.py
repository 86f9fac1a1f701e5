"""A question of the wizard, and what a typed text means."""

import re
from dataclasses import dataclass
from typing import Any, Final, Literal

Kind = Literal["text", "number", "numbers", "choice"]

_SPAN: Final = re.compile(r"(\S+)\s+to\s+(\S+)\s+step\s+(\S+)$")
_MOST_NODES: Final = 10_000


@dataclass(frozen=True)
class Choice:
    """One of several values.

    Attributes:
        value: as the cell file has it.
        words: what it is for.
    """

    value: Any
    words: str = ""

    @property
    def text(self) -> str:
        """The value as it is typed."""
        return text_of(self.value)


@dataclass(frozen=True)
class Question:
    """What is asked for one key of the cell file.

    Attributes:
        key: dotted, as in the cell file.
        title: in front of the field.
        help: what it is, with its unit and what an answer looks like.
        kind: how an answer is typed.
        choices: what can be chosen.
        find_out: what somebody has to find out who cannot answer; empty where the default serves.
        without: what is lost where it stays unanswered; empty where the answer is required or a default serves.
        default: what a driver takes without an answer; empty where the cell file's model knows it.
    """

    key: str
    title: str
    help: str
    kind: Kind = "text"
    choices: tuple[Choice, ...] = ()
    find_out: str = ""
    without: str = ""
    default: str = ""

    def value(self, text: str) -> Any:
        """Return what a typed text means; a text that means nothing stays itself, for the model to refuse."""
        match self.kind:
            case "number":
                return number_of(text)
            case "numbers":
                return numbers_of(text)
            case "choice":
                return next((choice.value for choice in self.choices if choice.text == text), text)
            case _:
                return text


def number_of(text: str) -> int | float | str:
    """Return a number; a text that is none is returned as it is."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def numbers_of(text: str) -> list[int | float | str] | str:
    """Return numbers: `-140 to 60 step 20`, or each of them: `-140, -120, 0`."""
    span = _SPAN.match(text.strip())
    if span:
        return _spaced(*span.groups()) or text
    return [number_of(part) for part in re.split(r"[\s,;\[\]]+", text) if part]


def text_of(value: Any) -> str:
    """Return a value as somebody would type it."""
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case list():
            return _spaced_text(value) or ", ".join(text_of(one) for one in value)
        case _:
            return str(value)


def _spaced(first: str, last: str, step: str) -> list[int | float | str]:
    """Return evenly spaced numbers; none when there is no such row."""
    try:
        low, high, by = float(first), float(last), float(step)
        count = int((high - low) / by + 1e-9) + 1
    except (ValueError, ZeroDivisionError, OverflowError):
        return []
    if not 2 <= count <= _MOST_NODES or by <= 0.0:
        return []
    return [round(low + i * by, 9) for i in range(count)]


def _spaced_text(values: list[Any]) -> str:
    """Return a row of numbers by its ends and step, where that means exactly these numbers."""
    if len(values) < 4 or not all(type(value) in {int, float} for value in values):
        return ""
    text = f"{values[0]!r} to {values[-1]!r} step {round(values[1] - values[0], 9)!r}"
    return text if numbers_of(text) == values else ""


YES_NO: Final = (Choice(True), Choice(False))
