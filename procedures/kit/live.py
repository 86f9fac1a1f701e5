"""A value that a technician watches, and the band that it has to lie in: the one judgement of that."""

from dataclasses import dataclass


def in_band(value: float, low: float | None, high: float | None) -> bool:
    """Return whether a value lies in a band; what is not a number lies in none that has a limit.

    Args:
        value: in the unit of the band.
        low: smallest accepted value; None for no lower limit.
        high: largest accepted value; None for no upper limit.
    """
    return (low is None or value >= low) and (high is None or value <= high)


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
    """

    name: str
    value: float
    unit: str
    low: float | None = None
    high: float | None = None
    text: str = ""

    @property
    def accepted(self) -> bool:
        """The value lies in its band."""
        return in_band(self.value, self.low, self.high)
