"""The events of a run, for a person on stderr or a program on stdout."""

import os
import sys
from typing import Final

from catseye.app.cli.event_channel import report_warning
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.question_line import QuestionLine, live_text
from catseye.app.errors import ReaderStuckError
from catseye.app.protocol.engine_events import Dropped
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.run_events import (
    TELEMETRY,
    DrivesLeft,
    ErrorReported,
    FirstMotionShown,
    Happened,
    LiveShown,
    Progressed,
    PromptAnswered,
    PromptAsked,
    RunEnded,
    StateFields,
    WarningIssued,
)
from catseye.app.protocol.state import ENDING, ControlState
from catseye.app.results.runs.event_text import first_motion_text, texts_of
from catseye.drivers.roles.text import harmless_lines

_SHOWN_STATES: Final = ENDING | {
    ControlState.STOPPED,
    ControlState.ABORTED,
    ControlState.SUSPENDED,
    ControlState.SUSPENDING,
    ControlState.UNSUSPENDING,
}


class Narrator:
    """Takes the events of one run.

    Args:
        as_json: events go to stdout as lines of JSON too.
        telemetry: so does what accompanies them; see `TELEMETRY`.
        go_on: what a person does about a held run.

    Attributes:
        interactive: questions are answered at this terminal.
    """

    def __init__(
        self, procedure: str, as_json: bool, go_on: str | None = None, *, telemetry: bool = False
    ) -> None:
        self.interactive = False
        self._procedure = procedure
        self._bar = ProgressBar(procedure, heard=True)
        self._question = QuestionLine()
        self._as_json = as_json
        self._telemetry = telemetry
        self._dropped = 0
        self._go_on = go_on or f"Ctrl-C again stops the run; kill -USR1 {os.getpid()} lets it go on"

    def publish(self, event: AnyEvent) -> None:
        """Show an event.

        Raises:
            OSError: stdout or stderr does not take it.
        """
        try:
            if self._as_json and (self._telemetry or not isinstance(event, TELEMETRY)):
                self._emit(event)
        finally:
            self._show_event(event)

    def entered(self) -> None:
        """A line was typed at this terminal."""
        self._question.entered()

    def show(self, text: str) -> None:
        """Write a line of talk; an open question is shown again below it."""
        self._bar.close()
        self._question.leave()
        note(text, heard=True)
        self._question.again()

    def _show_event(self, event: AnyEvent) -> None:
        match event:
            case Progressed() if self._question.asked is None:
                self._bar.update(event.done, event.total, event.text)
            case WarningIssued():
                self.show(f"warning: {event.text}")
                report_warning(harmless_lines(event.text))
            case ErrorReported():
                self.show(f"{event.trace}error: {event.text}")
            case PromptAsked() if self.interactive:
                self._bar.close()
                self._question.ask(event.prompt)
            case PromptAsked():
                self.show(f"question {event.id}: {event.text}")
            case PromptAnswered() if self._question.asked is not None:
                self._question.close()
                note(f"answer to {event.id}: {event.answer} ({event.who})", heard=True)
            case LiveShown():
                self._live(live_text(event.data))
            case DrivesLeft():
                self.show(event.data.text)
            case Happened() if (phrase := texts_of(self._procedure).get(event.kind)) and phrase.shown:
                self.show(phrase.sentence(event.kind, event.data))
            case FirstMotionShown():
                self.show(first_motion_text(event.data.json_object()))
            case StateFields():
                self._state(event)
            case RunEnded():
                self._question.close()
                self.show(f"run {event.status}: {event.path}")

    def _state(self, event: StateFields) -> None:
        if event.state is ControlState.HELD:
            self.show(f"HELD: {self._go_on}")
        elif event.state is ControlState.HOLDING and self._question.asked is not None:
            self.show("HOLDING: the run holds as soon as the question is answered; /g goes on, /s stops")
        elif event.state in _SHOWN_STATES:
            if event.state in ENDING:
                self._question.close()
            self.show(f"{event.state}: {event.reason}")

    def _live(self, text: str) -> None:
        if self._question.asked is not None:
            self._question.show(text)
        elif sys.stderr.isatty():
            self._bar.note(text)

    def _emit(self, event: AnyEvent) -> None:
        try:
            before = [Dropped(count=self._dropped).json_object()] if self._dropped else []
            write_document("events", *before, event.json_object())
            self._dropped = 0
        except ReaderStuckError:
            self._dropped += 1
            raise
        except OSError:
            # `[engine] on_output_lost` says what the engine does about it; people still read them on stderr.
            self._as_json = False
            raise
