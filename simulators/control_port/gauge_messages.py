"""Requests of the control port about a ball on the axis of a joint and the indicators that read it."""

from typing import Any

from pydantic import Field

from catseye.simulators.control_port.exchange import Answer, Request
from catseye.simulators.world.axis_gauge import Direction


class IndicatorReading(Answer):
    """What an indicator shows."""

    reading_um: float


class MountArtefact(Request[Answer]):
    """Fasten the ball to what a joint turns, and set the indicators to it.

    Attributes:
        joint: its number, from 1.
        turned: by half a turn against the joint, with the indicators on the other side.
    """

    op = "mount_artefact"
    joint: int = Field(ge=1)
    turned: bool = False


class TapArtefact(Request[Answer]):
    """Push the ball towards the indicator in x; away from it where negative."""

    op = "tap_artefact"
    by_um: float = Field(ge=-1000.0, le=1000.0)


class ReadIndicator(Request[IndicatorReading]):
    """What does an indicator show?"""

    op = "indicator"
    answer = IndicatorReading
    direction: Direction


class TakeIndicatorOff(Request[Answer]):
    """Take ball and indicators away."""

    op = "take_indicator_off"


GaugeRequest = MountArtefact | TapArtefact | ReadIndicator | TakeIndicatorOff

OPERATIONS: tuple[type[Request[Any]], ...] = (MountArtefact, TapArtefact, ReadIndicator, TakeIndicatorOff)
