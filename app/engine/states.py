"""The states of a run and what changes them; pure, the words are those of PackML.

A transition names what has to be done about it; somebody else does it.
"""

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """Where a run stands."""

    IDLE = "IDLE"
    STARTING = "STARTING"
    EXECUTE = "EXECUTE"
    HOLDING = "HOLDING"
    HELD = "HELD"
    UNHOLDING = "UNHOLDING"
    SUSPENDED = "SUSPENDED"
    SUSPENDING = "SUSPENDING"
    UNSUSPENDING = "UNSUSPENDING"
    STOPPING = "STOPPING"
    STOPPED = "STOPPED"
    ABORTING = "ABORTING"
    ABORTED = "ABORTED"
    CLEARING = "CLEARING"
    COMPLETE = "COMPLETE"


class Event(StrEnum):
    """What can happen to a run: requests, and reports that something requested is over."""

    START = "start"
    STARTED = "started"
    HOLD = "hold"
    HELD = "held"
    UNHOLD = "unhold"
    RESUMED = "resumed"
    SUSPEND = "suspend"
    CONDITION_BACK = "condition_back"
    INTERRUPT = "interrupt"
    INTERRUPTED = "interrupted"
    ACKNOWLEDGE = "acknowledge"
    STOP = "stop"
    STOPPED = "stopped"
    ABORT = "abort"
    ABORTED = "aborted"
    CLEAR = "clear"
    CLEARED = "cleared"
    DONE = "done"
    FAULT = "fault"


class Effect(StrEnum):
    """What a transition asks for."""

    PUBLISH = "publish"
    """Tell front ends and the store the new state."""

    PERMIT_MOTION = "permit_motion"
    """New motion may begin."""

    FORBID_MOTION = "forbid_motion"
    """No new motion begins; a move under way ends by itself."""

    STOP_ROBOT = "stop_robot"
    """Stop the robot now, past everything else; switch its drives off unless standstill is confirmed in time."""

    STOP_MOTION = "stop_motion"
    """Stop the robot now, past everything else; the run itself goes on."""

    REPORT_IGNORED = "report_ignored"
    """Say that the event means nothing here."""


@dataclass(frozen=True)
class Transition:
    """What an event leads to.

    Attributes:
        state: the new state.
        effects: what has to be done, in this order.
    """

    state: State
    effects: tuple[Effect, ...]


_HALT = (Effect.FORBID_MOTION, Effect.STOP_ROBOT, Effect.PUBLISH)
_INTERRUPT = (Effect.FORBID_MOTION, Effect.STOP_MOTION, Effect.PUBLISH)
_FORBID = (Effect.FORBID_MOTION, Effect.PUBLISH)
_PERMIT = (Effect.PERMIT_MOTION, Effect.PUBLISH)
_TELL = (Effect.PUBLISH,)

RUNNING = frozenset(
    {
        State.STARTING,
        State.EXECUTE,
        State.HOLDING,
        State.HELD,
        State.UNHOLDING,
        State.SUSPENDED,
        State.SUSPENDING,
        State.UNSUSPENDING,
    }
)
"""States of a run that goes on, now or later."""

INTERRUPTED = frozenset({State.SUSPENDING, State.UNSUSPENDING})
"""The surroundings stopped the robot: being brought to rest, then waiting until somebody acknowledges that."""

ENDED = frozenset({State.STOPPED, State.ABORTED, State.COMPLETE})
"""States in which a run stays."""

_TABLE: dict[tuple[State, Event], tuple[State, tuple[Effect, ...]]] = {
    (State.IDLE, Event.START): (State.STARTING, _TELL),
    (State.STARTING, Event.STARTED): (State.EXECUTE, _PERMIT),
    (State.EXECUTE, Event.HOLD): (State.HOLDING, _FORBID),
    (State.HOLDING, Event.HELD): (State.HELD, _TELL),
    # A hold that has not taken effect is simply withdrawn.
    (State.HOLDING, Event.UNHOLD): (State.EXECUTE, _PERMIT),
    (State.HELD, Event.UNHOLD): (State.UNHOLDING, _TELL),
    (State.UNHOLDING, Event.RESUMED): (State.EXECUTE, _PERMIT),
    (State.UNHOLDING, Event.HOLD): (State.HELD, _TELL),
    (State.EXECUTE, Event.SUSPEND): (State.SUSPENDED, _FORBID),
    (State.SUSPENDED, Event.CONDITION_BACK): (State.EXECUTE, _PERMIT),
    # The operator's hold outlasts the condition: only the operator ends it. It takes effect at a checkpoint, since a
    # move may have been under way when the run was suspended.
    (State.SUSPENDED, Event.HOLD): (State.HOLDING, _TELL),
    (State.SUSPENDING, Event.INTERRUPTED): (State.UNSUSPENDING, _TELL),
    # No condition that comes back by itself leads here: only an acknowledgement permits motion again.
    (State.UNSUSPENDING, Event.ACKNOWLEDGE): (State.EXECUTE, _PERMIT),
    (State.EXECUTE, Event.DONE): (State.COMPLETE, _FORBID),
    # The procedure may end before it meets another checkpoint.
    (State.HOLDING, Event.DONE): (State.COMPLETE, _TELL),
    (State.UNHOLDING, Event.DONE): (State.COMPLETE, _FORBID),
    (State.SUSPENDED, Event.DONE): (State.COMPLETE, _TELL),
    (State.UNSUSPENDING, Event.DONE): (State.COMPLETE, _TELL),
    (State.IDLE, Event.STOP): (State.STOPPED, _FORBID),
    (State.IDLE, Event.ABORT): (State.ABORTED, _FORBID),
    (State.STOPPING, Event.STOPPED): (State.STOPPED, _TELL),
    (State.STOPPING, Event.ABORT): (State.ABORTING, _HALT),
    (State.ABORTING, Event.ABORTED): (State.ABORTED, _TELL),
    (State.ABORTED, Event.CLEAR): (State.CLEARING, _TELL),
    (State.CLEARING, Event.CLEARED): (State.STOPPED, _TELL),
    (State.CLEARING, Event.ABORT): (State.ABORTING, _HALT),
}
_TABLE |= {
    (state, Event.INTERRUPT): (State.SUSPENDING, _INTERRUPT)
    for state in RUNNING - INTERRUPTED - {State.STARTING}
}
_TABLE |= {(state, Event.STOP): (State.STOPPING, _HALT) for state in RUNNING}
_TABLE |= {(state, Event.FAULT): (State.STOPPING, _HALT) for state in RUNNING}
_TABLE |= {(state, Event.ABORT): (State.ABORTING, _HALT) for state in RUNNING}


def transition(state: State, event: Event) -> Transition:
    """Return where an event leads; one that means nothing leaves the state and says so."""
    found = _TABLE.get((state, event))
    return Transition(*found) if found else Transition(state, (Effect.REPORT_IGNORED,))
