"""The controller's event log."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Final

_MOST: Final = 1000
_BEGAN: Final = datetime(2026, 1, 1, tzinfo=UTC)
_ERRORS_FROM: Final = 50_000


@dataclass(frozen=True)
class Event:
    """One entry.

    Attributes:
        number: it is the so-manieth.
        kind: 1 information, 2 warning, 3 error.
        code: what happened.
        time: when.
        title: what happened, in words.
    """

    number: int
    kind: int
    code: int
    time: str
    title: str


class EventLog:
    """The last events.

    Args:
        time_s: returns the bench time, s.

    Attributes:
        on_event: called with each new one.
    """

    def __init__(self, time_s: Callable[[], float]) -> None:
        self._time_s = time_s
        self._events: deque[Event] = deque(maxlen=_MOST)
        self._count = 0
        self.on_event: Callable[[Event], None] = lambda _event: None

    def add(self, code: int, title: str) -> None:
        """Note an event."""
        self._count += 1
        time = (_BEGAN + timedelta(seconds=self._time_s())).strftime("%Y-%m-%d T  %H:%M:%S")
        kind = 3 if code >= _ERRORS_FROM else 1
        event = Event(self._count, kind, code, time, title)
        self._events.append(event)
        self.on_event(event)

    def newest_first(self) -> list[Event]:
        """Return the events that are kept."""
        return list(reversed(self._events))
