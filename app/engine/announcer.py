"""Telling front ends what happens: the events of a headless run."""

from collections.abc import Callable
from typing import Literal

from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.context import Json

Publish = Callable[[dict[str, Json]], None]
"""Takes one event; must not block. An OSError means that the front end is gone."""

Kind = Literal[
    "run-started",
    "state",
    "step-started",
    "step-done",
    "point",
    "prompt",
    "answer",
    "warning",
    "error",
    "progress",
    "run-ended",
]  # fmt: skip - one line of the file format a line


class Announcer:
    """Publishes the events of one run.

    Args:
        run: the run's name.
        clock: of the run.
        publish: the front end.
        on_lost: called once when the front end is gone; what happens after that is still offered to it, since
            part of a front end may live on.
    """

    def __init__(self, run: str, clock: Clock, publish: Publish, on_lost: Callable[[], None]) -> None:
        self._run = run
        self._clock = clock
        self._publish = publish
        self._on_lost = on_lost
        self._lost = False

    def say(self, kind: Kind, /, **fields: Json) -> None:
        """Publish an event with the time and the run's name."""
        event: dict[str, Json] = {"t": self._clock.now_utc().isoformat(), "event": kind, "run": self._run}
        try:
            self._publish({**event, **fields})
        except OSError:
            if not self._lost:
                self._lost = True
                self._on_lost()
