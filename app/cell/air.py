"""What a cell file says about the air: how lengths are corrected for it, and in which air a measurement goes on."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from catseye.app.cell.model import Cell
from catseye.calibration.air import HE_NE_VACUUM_NM, Formula


@dataclass(frozen=True)
class AirRule:
    """How the program corrects for the air where the instrument does not.

    Attributes:
        formula: of the refractive index.
        co2_ppm: carbon dioxide, ppm.
        vacuum_wavelength_nm: of the laser, nm.
        max_age_s: how old a sample of the air may be, s of the clock.
    """

    formula: Formula = "ciddor"
    co2_ppm: float = 450.0
    vacuum_wavelength_nm: float = HE_NE_VACUUM_NM
    max_age_s: float = 2.0


@dataclass(frozen=True)
class AirLimits:
    """Ranges of the air in which a measurement goes on.

    Attributes:
        ranges: smallest and largest value by the name of the quantity in an air sample.
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def air_rule(cell: Cell) -> AirRule:
    """Return how the program corrects lengths for the air where the interferometer does not."""
    return AirRule(**cell.air.model_dump())


def air_limits(cell: Cell) -> AirLimits:
    """Return the air in which a measurement goes on."""
    given = cell.conditions.model_dump(exclude_none=True)
    return AirLimits({name: (low, high) for name, (low, high) in given.items()})
