"""What is asked of each kind of device between runs, and how often."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from catseye.app.service.watching.observed_devices import (
    ObservedDevice,
    ObservedInterferometer,
    ObservedIo,
    ObservedRobot,
    ObservedSensor,
    ObservedTracker,
)

Question = Callable[[], Awaitable[object]]

ROBOT_S = 0.25
BEAM_S = 0.1
STREAMED_BEAM_S = 0.25
DOOR_S = 0.5
AIR_S = 2.0
TRACKER_S = 5.0
"""Real seconds between two rounds of questions."""


@dataclass(frozen=True)
class Round:
    """Questions that are asked one after another, again and again.

    Attributes:
        period_s: from one round to the next, real s.
        questions: of a round; none for a device that only stays connected.
    """

    period_s: float
    questions: tuple[Question, ...] = ()


def round_for(device: ObservedDevice) -> Round:
    """Return what is asked of a device."""
    match device:
        case ObservedRobot():
            return Round(ROBOT_S, (device.status, device.joints))
        case ObservedInterferometer(streams=True):
            return Round(STREAMED_BEAM_S, (device.status,))
        case ObservedInterferometer():
            return Round(BEAM_S, (device.read, device.status))
        case ObservedSensor():
            return Round(AIR_S, (device.sample,))
        case ObservedIo():
            return Round(DOOR_S, (device.door_closed,))
        case ObservedTracker():
            return Round(TRACKER_S, (device.locate,))
    return Round(AIR_S)
