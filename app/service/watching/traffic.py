"""What goes over the wires, for whoever looks at it now: bounded, and what is left out is counted."""

from collections import deque

from catseye.app.protocol.bench import WireLine
from catseye.app.protocol.engine_events import WirePassed
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Entry

MOST_LINES = 200
"""Lines that wait to be published."""

SHOWN_BYTES = 256
"""Of one line; a longer one says how long it was."""


class Traffic:
    """Takes the bytes of every link while somebody listens. `record` is a wire recorder like that of a run's store.

    Args:
        clock: stamps the lines.

    Attributes:
        listening: somebody listens.
    """

    def __init__(self, clock: Clock) -> None:
        self.listening = False
        self._clock = clock
        self._lines: deque[WireLine] = deque(maxlen=MOST_LINES)
        self._missed = 0

    def record(self, device: str, entry: Entry, data: bytes) -> None:
        """Take an entry.

        Args:
            entry: what it holds.
            data: the bytes, as they went, or the text.
        """
        if not self.listening:
            return
        self._missed += len(self._lines) == MOST_LINES
        # Made ready here, a little at a time: all at once would hold up whoever reads an instrument meanwhile.
        line = WireLine(
            t=self._clock.now_utc().isoformat(),
            device=device,
            dir=entry,
            hex=data[:SHOWN_BYTES].hex(),
            bytes=len(data) if len(data) > SHOWN_BYTES else None,
        )
        self._lines.append(line)

    def take(self) -> WirePassed | None:
        """Return the lines since the last ones were taken; None when there is none."""
        if not self._lines:
            return None
        lines = tuple(self._lines)
        self._lines.clear()
        missed, self._missed = self._missed, 0
        return WirePassed(lines=lines, missed=missed)
