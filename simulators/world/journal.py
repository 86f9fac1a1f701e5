"""What happened on the bench: requests, motions, stops. A witness for tests, bounded in length."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

_LENGTH = 20_000


@dataclass(frozen=True)
class Entry:
    """One event.

    Attributes:
        time_s: bench time, s.
        kind: request, motion, fault or connection.
        text: what was asked or what happened.
    """

    time_s: float
    kind: str
    text: str


class Journal:
    """The last events of each device.

    Args:
        time_s: returns the bench time, s.
    """

    def __init__(self, time_s: Callable[[], float]) -> None:
        self._time_s = time_s
        self._entries: dict[str, deque[Entry]] = {}

    def add(self, device: str, kind: str, text: str) -> None:
        """Note an event of a device at the present bench time."""
        entries = self._entries.setdefault(device, deque(maxlen=_LENGTH))
        entries.append(Entry(self._time_s(), kind, text))

    def entries(self, device: str) -> list[Entry]:
        """Return the last events of a device, oldest first."""
        return list(self._entries.get(device, ()))
