"""Thermal expansion: lengths at the reference temperature of length metrology."""

import math
from dataclasses import dataclass

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


def at_reference(length_mm: float, u_mm: float, material: Material) -> tuple[float, float]:
    """Return a length at 20 °C and its standard uncertainty.

    Args:
        length_mm: at the material's temperature, mm.
        u_mm: its standard uncertainty, mm.
    """
    warmer_k = material.temperature_c - REFERENCE_C
    u_expansion = math.hypot(warmer_k * material.u_cte_per_k, material.cte_per_k * material.u_temperature_k)
    return length_mm / (1.0 + material.cte_per_k * warmer_k), math.hypot(u_mm, length_mm * u_expansion)
