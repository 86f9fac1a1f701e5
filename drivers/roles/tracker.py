"""An independent instrument that locates a target on the arm."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Protocol

from catseye.drivers.roles.device import Device, Role


@dataclass(frozen=True)
class Position:
    """A measured position, in the instrument's own frame.

    Attributes:
        x_mm: along x.
        y_mm: along y.
        u_mm: standard uncertainty of each coordinate.
    """

    x_mm: float
    y_mm: float
    u_mm: float


class Tracker(Device, Protocol):
    """An independent instrument, such as a laser tracker.

    Attributes:
        has_hands: its endpoint is the control port of an emulated bench, which does what operators are asked for.
    """

    role: ClassVar[Role] = "tracker"
    has_hands: ClassVar[bool] = False

    @abstractmethod
    async def locate(self) -> Position:
        """Return the position of the target."""
        ...
