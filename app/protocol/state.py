"""The control states of a run, in the words of PackML."""

from enum import StrEnum
from typing import Final


class ControlState(StrEnum):
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


BEFORE_MOTION: Final = frozenset({ControlState.IDLE, ControlState.STARTING})
"""The devices are not ready: nothing can be held, and nothing moves."""

HELD: Final = frozenset({ControlState.HOLDING, ControlState.HELD})
"""The operator has held the run; only an operator lets it go on."""

INTERRUPTED: Final = frozenset({ControlState.SUSPENDING, ControlState.UNSUSPENDING})
"""The surroundings stopped the robot: being brought to rest, then waiting until somebody acknowledges that."""

RUNNING: Final = frozenset(
    {
        ControlState.STARTING,
        ControlState.EXECUTE,
        ControlState.HOLDING,
        ControlState.HELD,
        ControlState.UNHOLDING,
        ControlState.SUSPENDED,
        ControlState.SUSPENDING,
        ControlState.UNSUSPENDING,
    }
)
"""States of a run that goes on, now or later."""

ENDING: Final = frozenset({ControlState.STOPPING, ControlState.ABORTING})
"""The robot is being brought to rest for good."""

ENDED: Final = frozenset({ControlState.STOPPED, ControlState.ABORTED, ControlState.COMPLETE})
"""States in which a run stays."""
