"""A value that a technician watches, and the band that it has to lie in: the one judgement of that."""

from dataclasses import dataclass

from catseye.drivers.roles.pose import Unit


def in_band(value: float, low: float | None, high: float | None, expanded: float = 0.0) -> bool:
    """Return whether a value lies in a band; what is not a number lies in none that has a limit.

    Args:
        value: in the unit of the band.
        low: smallest accepted value; None for no lower limit.
        high: largest accepted value; None for no upper limit.
        expanded: uncertainty U (k = 2) with which the value has to lie in it; 0 where the value alone is judged.
    """
    return (low is None or value - expanded >= low) and (high is None or value + expanded <= high)


@dataclass(frozen=True)
class LiveStep:
    """A step of an arm as its plateaus look while the series goes on; results come from the whole recording.

    Attributes:
        series: what is stepped where.
        number: of the step, from 1.
        count: of the series.
        command: signed size, in the unit.
        measured: signed size, positive in the direction that positive commands lead to.
        position: of the plateau after it, from the one before the first step.
        unit: of all three.
        error_percent: of the command.
        band_percent: largest error that is shown as accepted.
        torque_nm: of the motor at its end; None where the controller states none.
        below: the command lies below what the instrument resolves: its error says nothing about the arm.
    """

    series: str
    number: int
    count: int
    command: float
    measured: float
    position: float
    unit: Unit
    error_percent: float
    band_percent: float
    torque_nm: float | None = None
    below: bool = False


@dataclass(frozen=True)
class Live:
    """A value that a technician watches while it changes.

    Attributes:
        name: of the quantity.
        value: now.
        unit: of the value and its band.
        low: smallest accepted value; None for no lower limit.
        high: largest accepted value; None for no upper limit.
        text: what to do about it, one sentence; empty when there is nothing to do.
        step: that the value is of; None where it is of no step.
        expanded: uncertainty U (k = 2) with which the value has to lie in its band; 0 where it is judged alone.
    """

    name: str
    value: float
    unit: str
    low: float | None = None
    high: float | None = None
    text: str = ""
    step: LiveStep | None = None
    expanded: float = 0.0

    @property
    def accepted(self) -> bool:
        """The value lies in its band, with its uncertainty."""
        return in_band(self.value, self.low, self.high, self.expanded)
