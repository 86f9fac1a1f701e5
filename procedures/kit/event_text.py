"""Events and observations as sentences. They are read from old runs too: a value may be missing."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

_LONGEST = 160

Data = Mapping[str, Any]
"""What was stored with an event."""


@dataclass(frozen=True)
class EventText:
    """How an event reads.

    Attributes:
        text: returns a sentence; empty where another line says it.
        passing: it says how far a quantity has got: of several in a row the last one counts.
        shown: it is what a run is made for, so a person at the terminal reads it at once.
    """

    text: Callable[[Data], str]
    passing: bool = False
    shown: bool = False

    def sentence(self, kind: str, data: Data) -> str:
        """Return the sentence; by its names where it cannot be made, as of an event of another version."""
        try:
            return self.text(data)
        except Exception:  # noqa: BLE001  # somebody else's words must not keep a run from being read
            return plain_text(kind, data)


EventTexts = Mapping[str, EventText]
"""By the kind of the event."""


def plain_text(kind: str, data: Data) -> str:
    """Return anything that was stored, by its names."""
    parts = ", ".join(f"{key} {value_text(value)}" for key, value in data.items() if value not in (None, ""))
    text = f"{kind}: {parts}" if parts else kind
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def value_text(value: object) -> str:
    """Return a stored value, numbers to six digits."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
