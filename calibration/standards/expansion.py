"""Thermal expansion: lengths at the reference temperature of length metrology."""

import math
from dataclasses import dataclass

from catseye.calibration.core.arguments import require_finite, require_not_negative

REFERENCE_C = 20.0


@dataclass(frozen=True)
class Material:
    """What a part is made of, and how warm it was.

    Attributes:
        temperature_c: its mean temperature, °C.
        u_temperature_k: standard uncertainty of that, K.
        cte_per_k: coefficient of thermal expansion, 1/K.
        u_cte_per_k: standard uncertainty of that, 1/K.
    """

    temperature_c: float
    u_temperature_k: float
    cte_per_k: float
    u_cte_per_k: float

    def __post_init__(self) -> None:
        require_finite([self.temperature_c, self.cte_per_k], "temperature_c, cte_per_k")
        require_not_negative([self.u_temperature_k, self.u_cte_per_k], "u_temperature_k, u_cte_per_k")


def at_reference(length_mm: float, u_mm: float, material: Material) -> tuple[float, float]:
    """Return a length at 20 °C and its standard uncertainty.

    Args:
        length_mm: at the material's temperature, mm.
        u_mm: its standard uncertainty, mm.

    Raises:
        ArgumentError: the length is not finite, or the uncertainty negative.
    """
    require_finite(length_mm, "length_mm")
    require_not_negative(u_mm, "u_mm")
    warmer_k = material.temperature_c - REFERENCE_C
    u_expansion = math.hypot(warmer_k * material.u_cte_per_k, material.cte_per_k * material.u_temperature_k)
    return length_mm / (1.0 + material.cte_per_k * warmer_k), math.hypot(u_mm, length_mm * u_expansion)
