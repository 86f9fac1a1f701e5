"""A job shown to people on stderr and to programs on stdout, for as long as they take it."""

from contextlib import suppress

from catseye.app.cli.narrator import Narrator
from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.protocol.campaign_events import CampaignEnded, CampaignEvent, StageEnded, StageStarted
from catseye.app.protocol.commands import CommandEvent, CommandProgress, CommandWarning
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.message import Event
from catseye.app.protocol.run_events import TELEMETRY
from catseye.app.results.numbers import duration_text
from catseye.drivers.roles.text import harmless_lines


class CampaignTeller:
    """Shows a job: to people on stderr, to programs on stdout.

    Messages are not the measurement: where stdout or stderr takes no more, the job goes on without it.

    Args:
        as_json: every event goes to stdout.
    """

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self._lost = False
        self._narrator: Narrator | None = None
        self._bar: ProgressBar | None = None

    def say(self, event: CampaignEvent) -> None:
        """Show an event of the job."""
        if isinstance(event, CampaignEnded):
            self._write("campaign-verdict", event)
        else:
            self._write("campaign-events", event)
        with suppress(OSError):
            self._say(event)

    def told(self, event: AnyEvent) -> None:
        """Show an event of a run."""
        if not isinstance(event, TELEMETRY):
            self._write("events", event)
        if self._narrator is not None:
            with suppress(OSError):
                self._narrator.publish(event)

    def heard(self, event: CommandEvent) -> None:
        """Show what a command on stored data reports."""
        with suppress(OSError):
            match event:
                case CommandProgress() if self._bar is not None:
                    self._bar.update(event.share, 1.0, event.text)
                case CommandWarning():
                    warn(harmless_lines(event.text))
                case _:
                    pass

    def _write(self, name: str, event: Event) -> None:
        if not self._as_json:
            return
        try:
            write_document(name, event.json_object())
        except OSError as error:
            if not self._lost:
                self._lost = True
                with suppress(OSError):
                    warn(f"{error}; the job goes on, and writes its verdict into its folder")

    def _say(self, event: CampaignEvent) -> None:
        match event:
            case StageStarted():
                attempt = f", try {event.attempt}" if event.attempt > 1 else ""
                self._bar = ProgressBar(event.stage)
                self._narrator = Narrator(event.stage, as_json=False)
                note(f"stage {event.number} of {event.count}{attempt}: {event.command}")
                note(f"time left, as earlier runs took: {_left(event)}")
            case StageEnded():
                if self._bar is not None:
                    self._bar.close()
                note(f"{event.result.stage}: {event.result.verdict}, {event.result.text}")
            case _:
                pass


def _left(event: StageStarted) -> str:
    if event.left_s is None:
        return "unknown"
    unknown = f", without {', '.join(event.unknown)}" if event.unknown else ""
    return f"{duration_text(event.left_s, whole=True)}{unknown}"
