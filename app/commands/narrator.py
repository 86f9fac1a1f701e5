"""The events of a run, told to a person on stderr or to a program on stdout."""

import os

from app.commands.output import emit_json, say
from app.commands.progress import ProgressBar
from procedures.context import Json

_STATES_WORTH_TELLING = {"STOPPING", "STOPPED", "ABORTING", "ABORTED", "SUSPENDED"}


class Narrator:
    """Takes the events of one run.

    Args:
        title: what is under way.
        as_json: every event goes to stdout as a line of JSON too.
    """

    def __init__(self, title: str, as_json: bool) -> None:
        self._bar = ProgressBar(title)
        self._as_json = as_json

    def publish(self, event: dict[str, Json]) -> None:
        """Tell an event."""
        if self._as_json:
            self._emit(event)
        match event["event"]:
            case "progress":
                self._bar.update(_number(event["done"]), _number(event["total"]), str(event["text"]))
            case "warning":
                self._say(f"warning: {event['text']}")
            case "error":
                self._say(f"error: {event['text']}")
            case "prompt":
                self._say(f"question {event['id']}: {event['text']}")
            case "state" if event.get("state") == "HELD" and "reason" in event:
                self._say(f"HELD: Ctrl-C again stops the run; kill -USR1 {os.getpid()} lets it go on")
            case "state" if event.get("state") in _STATES_WORTH_TELLING and "reason" in event:
                self._say(f"{event['state']}: {event['reason']}")
            case "run-ended":
                self._say(f"run {event['status']}: {event['path']}")

    def _emit(self, event: dict[str, Json]) -> None:
        try:
            emit_json(event)
        except OSError:
            # The engine holds the run when it hears of this; people are still told on stderr.
            self._as_json = False
            self._say(
                f"stdout is gone; the run is held. kill -USR1 {os.getpid()} lets it go on, -TERM ends it"
            )
            raise

    def _say(self, text: str) -> None:
        self._bar.close()
        say(text)


def _number(value: Json) -> float:
    return float(value) if isinstance(value, (int, float)) else 0.0
