"""Publishing what happens in a run, stamped with its time and name."""

from collections.abc import Callable

from catseye.app.protocol.run_events import RunEvent
from catseye.drivers.roles.clock import Clock

Publish = Callable[[RunEvent], None]
"""Takes one event; must not block. An OSError means that the front end is gone."""


class Announcer:
    """Publishes the events of one run.

    Args:
        run: the run's name.
        publish: the front end.
        on_lost: called once, with the cause, when the front end is gone; what happens after that is still offered to
            it, since part of a front end may live on.

    Attributes:
        missed: how many events the front end, or part of it, has not taken.
    """

    def __init__(self, run: str, clock: Clock, publish: Publish, on_lost: Callable[[OSError], None]) -> None:
        self.missed = 0
        self._run = run
        self._clock = clock
        self._publish = publish
        self._on_lost = on_lost

    def publish(self, event: RunEvent) -> None:
        """Publish an event with the time and the run's name."""
        try:
            self._publish(event.stamped(self._clock.now_utc().isoformat(), self._run))
        except OSError as error:
            self.missed += 1
            if self.missed == 1:
                self._on_lost(error)
