"""What a cell file says about the air in which a measurement goes on."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from catseye.app.cell.model import Cell


@dataclass(frozen=True)
class AirLimits:
    """Ranges of the air in which a measurement goes on.

    Attributes:
        ranges: smallest and largest value by the name of the quantity in an air sample.
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def air_limits(cell: Cell) -> AirLimits:
    """Return the air in which a measurement goes on."""
    given = cell.conditions.model_dump(exclude_none=True)
    return AirLimits({name: (low, high) for name, (low, high) in given.items()})
