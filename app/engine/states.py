"""The states of a run and what changes them; pure, the words are those of PackML.

A transition names what has to be done about it; somebody else does it.
"""

from dataclasses import dataclass
from enum import StrEnum

from catseye.app.protocol.state import INTERRUPTED, RUNNING, ControlState


class Trigger(StrEnum):
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
    """Publish the new state to front ends and store."""

    PERMIT_MOTION = "permit_motion"
    """New motion may begin."""

    FORBID_MOTION = "forbid_motion"
    """No new motion begins; a move under way ends by itself."""

    STOP_ROBOT = "stop_robot"
    """Stop the robot now, past everything else; switch its drives off unless standstill is confirmed in time."""

    STOP_MOTION = "stop_motion"
    """Stop the robot now, past everything else; the run itself goes on."""

    REPORT_IGNORED = "report_ignored"
    """Say that the trigger means nothing here."""


@dataclass(frozen=True)
class Transition:
    """What a trigger leads to.

    Attributes:
        state: the new state.
        effects: what has to be done, in this order.
    """

    state: ControlState
    effects: tuple[Effect, ...]


_HALT = (Effect.FORBID_MOTION, Effect.STOP_ROBOT, Effect.PUBLISH)
_INTERRUPT = (Effect.FORBID_MOTION, Effect.STOP_MOTION, Effect.PUBLISH)
_FORBID = (Effect.FORBID_MOTION, Effect.PUBLISH)
_PERMIT = (Effect.PERMIT_MOTION, Effect.PUBLISH)
_PUBLISH = (Effect.PUBLISH,)

_TABLE: dict[tuple[ControlState, Trigger], tuple[ControlState, tuple[Effect, ...]]] = {
    (ControlState.IDLE, Trigger.START): (ControlState.STARTING, _PUBLISH),
    (ControlState.STARTING, Trigger.STARTED): (ControlState.EXECUTE, _PERMIT),
    (ControlState.EXECUTE, Trigger.HOLD): (ControlState.HOLDING, _FORBID),
    (ControlState.HOLDING, Trigger.HELD): (ControlState.HELD, _PUBLISH),
    # A hold that has not taken effect is simply withdrawn.
    (ControlState.HOLDING, Trigger.UNHOLD): (ControlState.EXECUTE, _PERMIT),
    (ControlState.HELD, Trigger.UNHOLD): (ControlState.UNHOLDING, _PUBLISH),
    (ControlState.UNHOLDING, Trigger.RESUMED): (ControlState.EXECUTE, _PERMIT),
    (ControlState.UNHOLDING, Trigger.HOLD): (ControlState.HELD, _PUBLISH),
    (ControlState.EXECUTE, Trigger.SUSPEND): (ControlState.SUSPENDED, _FORBID),
    (ControlState.SUSPENDED, Trigger.CONDITION_BACK): (ControlState.EXECUTE, _PERMIT),
    # The operator's hold outlasts the condition: only the operator ends it. It takes effect at a checkpoint, since a
    # move may have been under way when the run was suspended.
    (ControlState.SUSPENDED, Trigger.HOLD): (ControlState.HOLDING, _PUBLISH),
    (ControlState.SUSPENDING, Trigger.INTERRUPTED): (ControlState.UNSUSPENDING, _PUBLISH),
    # No condition that comes back by itself leads here: only an acknowledgement permits motion again.
    (ControlState.UNSUSPENDING, Trigger.ACKNOWLEDGE): (ControlState.EXECUTE, _PERMIT),
    (ControlState.EXECUTE, Trigger.DONE): (ControlState.COMPLETE, _FORBID),
    # The procedure may end before it meets another checkpoint.
    (ControlState.HOLDING, Trigger.DONE): (ControlState.COMPLETE, _PUBLISH),
    (ControlState.UNHOLDING, Trigger.DONE): (ControlState.COMPLETE, _FORBID),
    (ControlState.SUSPENDED, Trigger.DONE): (ControlState.COMPLETE, _PUBLISH),
    (ControlState.UNSUSPENDING, Trigger.DONE): (ControlState.COMPLETE, _PUBLISH),
    (ControlState.IDLE, Trigger.STOP): (ControlState.STOPPED, _FORBID),
    (ControlState.IDLE, Trigger.ABORT): (ControlState.ABORTED, _FORBID),
    (ControlState.STOPPING, Trigger.STOPPED): (ControlState.STOPPED, _PUBLISH),
    (ControlState.STOPPING, Trigger.ABORT): (ControlState.ABORTING, _HALT),
    (ControlState.ABORTING, Trigger.ABORTED): (ControlState.ABORTED, _PUBLISH),
    (ControlState.ABORTED, Trigger.CLEAR): (ControlState.CLEARING, _PUBLISH),
    (ControlState.CLEARING, Trigger.CLEARED): (ControlState.STOPPED, _PUBLISH),
    (ControlState.CLEARING, Trigger.ABORT): (ControlState.ABORTING, _HALT),
}
_TABLE |= {
    (state, Trigger.INTERRUPT): (ControlState.SUSPENDING, _INTERRUPT)
    for state in RUNNING - INTERRUPTED - {ControlState.STARTING}
}
_TABLE |= {(state, Trigger.STOP): (ControlState.STOPPING, _HALT) for state in RUNNING}
_TABLE |= {(state, Trigger.FAULT): (ControlState.STOPPING, _HALT) for state in RUNNING}
_TABLE |= {(state, Trigger.ABORT): (ControlState.ABORTING, _HALT) for state in RUNNING}


def transition(state: ControlState, trigger: Trigger) -> Transition:
    """Return where a trigger leads; one that means nothing leaves the state and says so."""
    found = _TABLE.get((state, trigger))
    return Transition(*found) if found else Transition(state, (Effect.REPORT_IGNORED,))
