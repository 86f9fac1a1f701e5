"""Steps that a model of a joint is fitted to: data alone, for whoever has others fit them."""

from dataclasses import dataclass

from catseye.calibration.core.arguments import (
    require_directions,
    require_finite,
    require_positive,
    require_shape,
)
from catseye.calibration.core.types import Floats

FEWEST = 20
"""Steps below which a spread says nothing about how it grows."""


@dataclass(frozen=True)
class MeasuredSteps:
    """Steps of one joint in one direction.

    Attributes:
        joint: its name.
        direction: 1 or -1.
        positions: of the joint at each step's test, deg or mm, shape (n,).
        commands: sizes, positive, deg or mm, shape (n,).
        errors_percent: of each step, shape (n,).
    """

    joint: str
    direction: int
    positions: Floats
    commands: Floats
    errors_percent: Floats

    def __post_init__(self) -> None:
        require_directions(self.direction, f"direction of {self.name}")
        for values, what in (
            (self.positions, "positions"),
            (self.commands, "commands"),
            (self.errors_percent, "errors"),
        ):
            require_shape(values, (self.commands.size,), f"{what} of {self.name}")
            require_finite(values, f"{what} of {self.name}")
        require_positive(self.commands, f"commands of {self.name}")

    @property
    def name(self) -> str:
        """As messages call them."""
        return f"{self.joint} in direction {self.direction:+d}"
