"""What goes over the wires, for whoever looks at it now: bounded, and what is left out is counted."""

from collections import deque

from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.context import Json

MOST_LINES = 200
"""Lines that wait to be told."""

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
        self._lines: deque[Json] = deque(maxlen=MOST_LINES)
        self._missed = 0

    def record(self, device: str, direction: str, data: bytes) -> None:
        """Take bytes.

        Args:
            device: its name in the cell file.
            direction: "tx" is sent, "rx" is received.
            data: the bytes, as they went.
        """
        if not self.listening:
            return
        self._missed += len(self._lines) == MOST_LINES
        # Made ready here, a little at a time: all at once would hold up whoever reads an instrument meanwhile.
        line: dict[str, Json] = {
            "t": self._clock.now_utc().isoformat(),
            "device": device,
            "dir": direction,
            "hex": data[:SHOWN_BYTES].hex(),
        }
        if len(data) > SHOWN_BYTES:
            line["bytes"] = len(data)
        self._lines.append(line)

    def take(self) -> dict[str, Json] | None:
        """Return the lines since the last ones were taken, as a `wire` event has them; None when there is none."""
        if not self._lines:
            return None
        lines = list(self._lines)
        self._lines.clear()
        missed, self._missed = self._missed, 0
        return {"lines": lines, "missed": missed}
