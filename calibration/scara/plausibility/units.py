"""Units of length that a column may be in, by what they are worth in mm."""

from typing import Final

_NEAR: Final = 0.03
"""Links, places and wavelength of a sound bench let a unit seem off by less."""

_WAVELENGTH_MM: Final = 632.8e-6
"""Of a helium-neon laser."""

_UNITS: Final[dict[str, float]] = {
    "m": 1e3,
    "cm": 10.0,
    "inches": 25.4,
    "mm that were taken for inches": 1.0 / 25.4,
    "µm": 1e-3,
    "nm": 1e-6,
    **{f"counts of λ/{2**k}": _WAVELENGTH_MM / 2**k for k in range(1, 13)},
}


def unit_of(factor: float) -> str | None:
    """Return the unit whose numbers have to be multiplied by a factor to be mm; None for a factor of no unit."""
    return next((name for name, mm in _UNITS.items() if abs(factor / mm - 1.0) <= _NEAR), None)
