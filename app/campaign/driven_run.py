"""What the events of a run under a job say of its end."""

from typing import Final

from catseye.app.exitcode import ExitCode
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.run_events import RunEnded, StateChanged
from catseye.app.protocol.state import ENDED, ENDING, HELD, INTERRUPTED, ControlState

_UNTIL_SOMEBODY_COMES: Final = HELD | INTERRUPTED

_AT_REST: Final = frozenset({"aborted", "stopped"})
"""How a run ends that has brought the arm to rest; one that only refused to move has failed."""


class DrivenRun:
    """Takes the events of one run.

    Attributes:
        ended: its last event; None before.
    """

    def __init__(self) -> None:
        self.ended: RunEnded | None = None
        self._state: ControlState | None = None

    def take(self, event: AnyEvent) -> None:
        """Take an event."""
        if isinstance(event, RunEnded):
            self.ended = event
        elif isinstance(event, StateChanged) and event.state not in ENDING | ENDED:
            self._state = event.state

    @property
    def text(self) -> str:
        """Why it did not complete; empty where it did, or has not said so."""
        return "" if self.ended is None else self.ended.text

    @property
    def left_to_people(self) -> bool:
        """Whether the arm was stopped so that only a person may let it move again, of a run that did not complete.

        As after an abort for safety, a stop that nobody has acknowledged, or a hold that nobody has ended, whatever
        ended the run meanwhile. What was suspended until beam or air are back is nobody's affair.
        """
        if self._state in _UNTIL_SOMEBODY_COMES:
            return True
        ended = self.ended
        return ended is not None and ended.status in _AT_REST and ended.exit_code == ExitCode.SAFETY
