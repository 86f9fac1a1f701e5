"""The last events of a run, for clients that come later."""

from dataclasses import dataclass

from catseye.app.protocol.run_events import (
    LiveShown,
    Progressed,
    PromptAnswered,
    PromptAsked,
    RunEnded,
    RunEvent,
    StateChanged,
    StepDone,
    StepStarted,
)


@dataclass
class LatestEvents:
    """What a snapshot says of the run under way."""

    state: StateChanged | None = None
    step: StepStarted | None = None
    prompt: PromptAsked | None = None
    progress: Progressed | None = None
    live: LiveShown | None = None

    def take(self, event: RunEvent) -> None:
        """Remember an event."""
        match event:
            case LiveShown():
                self.live = event
            case StateChanged():
                self.state = event
            case StepStarted():
                self.step = event
            case StepDone():
                self.step = None
            case PromptAsked():
                self.prompt = event
            case PromptAnswered() | RunEnded():
                self.prompt = self.live = None
            case Progressed():
                self.progress = event
