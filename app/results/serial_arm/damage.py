"""Parameters of a result file that nobody can have identified: their name contradicts their unit, or their value."""

from typing import Final

from catseye.calibration.serial_arm.bounds import BOUNDS

DAMAGED: Final = "the file is damaged, or somebody has changed it"

_UNITS: Final = {"_rad_per_nmm": "rad/(N·mm)", "_mm": "mm", "_deg": "deg"}
"""By the end of a name."""

_UNWRITTEN: Final = str.maketrans("", "", "()·*. ")
"""Signs that a unit may be written with or without."""

_LINKS_MM: Final = (".a_mm", ".d_mm")
_LINKS_DEG: Final = (".alpha_deg", ".beta_deg", ".theta_offset_deg")

_WIDE: Final = 2.0
"""Times the bounds of the gate, and beyond them three standard uncertainties."""


def require_unit(name: str, unit: str) -> None:
    """Refuse a parameter whose unit is not that of its name.

    Raises:
        ValueError: names both.
    """
    wanted = next((one for end, one in _UNITS.items() if name.endswith(end)), unit)
    if unit and unit.translate(_UNWRITTEN) != wanted.translate(_UNWRITTEN):
        raise ValueError(f"{name} is stated in {unit}, and its name says {wanted}: {DAMAGED}")


def require_near(name: str, value: float, nominal: float, u: float) -> None:
    """Refuse a link that is farther from its drawing than the gate lets any result be.

    Raises:
        ValueError: names value and nominal value.
    """
    if name.endswith(_LINKS_MM):
        most = BOUNDS.length_mm
    elif name.endswith(_LINKS_DEG):
        most = BOUNDS.angle_deg
    else:
        return
    if abs(value - nominal) > _WIDE * most + 3.0 * u:
        raise ValueError(
            f"{name} is {value:g} and nominally {nominal:g}, farther apart than any calibration is kept: {DAMAGED}"
        )
