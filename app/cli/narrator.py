"""The events of a run, told to a person on stderr or to a program on stdout."""

import os
import sys

from catseye.app.cli.output import emit_json, say
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.question_line import QuestionLine, live_text
from catseye.app.service.questions import prompt_of
from catseye.app.story.words import first_motion_text
from catseye.procedures.kit.context import Json

_ENDING = {"STOPPING", "ABORTING"}
_STATES_WORTH_TELLING = {
    "STOPPING",
    "STOPPED",
    "ABORTING",
    "ABORTED",
    "SUSPENDED",
    "SUSPENDING",
    "UNSUSPENDING",
}


class Narrator:
    """Takes the events of one run.

    Args:
        title: what is under way.
        as_json: every event goes to stdout as a line of JSON too.
        go_on: what a person does about a held run.

    Attributes:
        interactive: questions are answered at this terminal.
    """

    def __init__(self, title: str, as_json: bool, go_on: str | None = None) -> None:
        self.interactive = False
        self._bar = ProgressBar(title)
        self._question = QuestionLine()
        self._as_json = as_json
        self._go_on = go_on or f"Ctrl-C again stops the run; kill -USR1 {os.getpid()} lets it go on"

    def publish(self, event: dict[str, Json]) -> None:
        """Tell an event."""
        if self._as_json:
            self._emit(event)
        match event["event"]:
            case "progress" if self._question.asked is None:
                self._bar.update(_number(event["done"]), _number(event["total"]), str(event["text"]))
            case "warning":
                self.tell(f"warning: {event['text']}")
            case "error":
                self.tell(f"error: {event['text']}")
            case "prompt" if self.interactive:
                self._bar.close()
                self._question.ask(prompt_of(event))
            case "prompt":
                self.tell(f"question {event['id']}: {event['text']}")
            case "answer":
                self._answered(event)
            case "state":
                self._state(event)
            case "run-ended":
                self._question.close()
                self.tell(f"run {event['status']}: {event['path']}")

    def entered(self) -> None:
        """A line was typed at this terminal."""
        self._question.entered()

    def tell(self, text: str) -> None:
        """Write a line of talk; an open question is shown again below it."""
        self._bar.close()
        self._question.leave()
        say(text)
        self._question.again()

    def _state(self, event: dict[str, Json]) -> None:
        data = event.get("data")
        if event.get("kind") == "live" and isinstance(data, dict):
            self._live(live_text(data))
        elif event.get("kind") == "drives" and isinstance(data, dict):
            self.tell(str(data["text"]))
        elif event.get("kind") == "first-motion" and isinstance(data, dict):
            self.tell(first_motion_text(data))
        elif event.get("state") == "HELD" and "reason" in event:
            self.tell(f"HELD: {self._go_on}")
        elif event.get("state") == "HOLDING" and self._question.asked is not None and "reason" in event:
            self.tell("HOLDING: the run holds as soon as the question is answered; /g goes on, /s stops")
        elif event.get("state") in _STATES_WORTH_TELLING and "reason" in event:
            if event["state"] in _ENDING:
                self._question.close()
            self.tell(f"{event['state']}: {event['reason']}")

    def _live(self, text: str) -> None:
        if self._question.asked is not None:
            self._question.show(text)
        elif sys.stderr.isatty():
            self._bar.note(text)

    def _answered(self, event: dict[str, Json]) -> None:
        if self._question.asked is not None:
            self._question.close()
            say(f"answer to {event['id']}: {event['answer']} ({event['who']})")

    def _emit(self, event: dict[str, Json]) -> None:
        try:
            emit_json(event)
        except OSError:
            # The engine holds the run when it hears of this; people are still told on stderr.
            self._as_json = False
            self.tell(
                f"stdout is gone; the run is held. kill -USR1 {os.getpid()} lets it go on, -TERM ends it"
            )
            raise


def _number(value: Json) -> float:
    return float(value) if isinstance(value, (int, float)) else 0.0
