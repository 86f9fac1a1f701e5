"""How long a run waits for somebody, or for its surroundings."""

from collections.abc import Iterator
from contextlib import contextmanager

from catseye.drivers.roles.clock import Clock


class WaitTime:
    """Keeps the times at which a run is held or suspended, and those at which a question is open.

    Attributes:
        reason: what it waits for now, or waited for last, as people read it.
    """

    def __init__(self, clock: Clock) -> None:
        self.reason = ""
        self._clock = clock
        self._sum_s = 0.0
        self._idle_since_s: float | None = None
        self._asks_since_s: float | None = None

    @property
    def idle_s(self) -> float:
        """How long the run was held or suspended so far, a wait that goes on included."""
        since_s = self._idle_since_s
        return self._sum_s + (0.0 if since_s is None else self._clock.monotonic_s() - since_s)

    @property
    def since_s(self) -> float | None:
        """Since when it has been held or suspended, or a question open, s of the clock; None while it goes on."""
        since = [start_s for start_s in (self._idle_since_s, self._asks_since_s) if start_s is not None]
        return min(since, default=None)

    @property
    def asks(self) -> bool:
        """A question is open."""
        return self._asks_since_s is not None

    @contextmanager
    def asking(self, prompt_id: str) -> Iterator[None]:
        """Have a question open meanwhile."""
        self._asks_since_s = self._clock.monotonic_s()
        if self._idle_since_s is None:
            self.reason = f"the question {prompt_id!r} was open"
        try:
            yield
        finally:
            self._asks_since_s = None

    def count(self, *, idle: bool, reason: str) -> None:
        """Take note of whether the run is held or suspended now, and why."""
        if not idle:
            self._sum_s, self._idle_since_s = self.idle_s, None
            return
        self.reason = reason
        if self._idle_since_s is None:
            self._idle_since_s = self._clock.monotonic_s()
