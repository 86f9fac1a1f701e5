"""The stop ladder: what a press of Ctrl-C asks for, in every front end.

A press asks for the next rung above what the run obeys already. A run that moves, or is about to, is held: a stop in
the middle of a motion loses the segment. One that waits, for whatever, is stopped: another hold would change nothing.
One that is being stopped is aborted. Above an abort there is only the emergency stop.

The engine applies the table, to the state that it is in: a client's view is a message old, and two quick presses
would both hold. A client sends `ladder`; see `ctrl_c_of_client` for when it does not. The STOP key is no part of it:
it always asks for `stop`, and may be pressed again and again.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Final, Literal

from catseye.app.protocol.state import ControlState


class Rung(StrEnum):
    """What stops a run, from the mildest on; the names are those of the requests."""

    HOLD = "hold"
    STOP = "stop"
    ABORT = "abort"


_CTRL_C: Final[Mapping[ControlState, Rung | None]] = {
    # Nothing moves yet and nothing can be held.
    ControlState.IDLE: Rung.STOP,
    ControlState.STARTING: Rung.STOP,
    ControlState.EXECUTE: Rung.HOLD,
    # No motion is permitted before the run has resumed, so a hold is as safe as a stop and keeps the segment.
    ControlState.UNHOLDING: Rung.HOLD,
    ControlState.HOLDING: Rung.STOP,
    ControlState.HELD: Rung.STOP,
    ControlState.SUSPENDED: Rung.STOP,
    ControlState.SUSPENDING: Rung.STOP,
    ControlState.UNSUSPENDING: Rung.STOP,
    ControlState.CLEARING: Rung.STOP,
    ControlState.STOPPING: Rung.ABORT,
    ControlState.ABORTING: None,
    ControlState.STOPPED: None,
    ControlState.ABORTED: None,
    ControlState.COMPLETE: None,
}


def rung_of(state: ControlState) -> Rung | None:
    """Return what a press of Ctrl-C asks of a run; None where nothing is left to ask."""
    return _CTRL_C[state]


def top_text(state: ControlState) -> str:
    """Return why no rung is left, for people."""
    if state is ControlState.ABORTING:
        return "the run is being aborted: use the emergency stop if the arm moves"
    return f"the run has ended: it is in state {state}"


Way = Literal["ladder", "stop-by-every-way", "nothing"]
"""The request `ladder`, STOP by every way that leads to an engine, or a word on how to quit."""


def ctrl_c_of_client(*, answers: bool, out_of_sight: bool, active: bool) -> Way:
    """Return what a client does when Ctrl-C is pressed.

    Args:
        answers: an engine is connected and not silent.
        out_of_sight: a run was under way when the connection broke.
        active: a run, a jog or a raw link is under way, or a run is about to begin.
    """
    if out_of_sight or (active and not answers):
        return "stop-by-every-way"
    return "ladder" if active else "nothing"
