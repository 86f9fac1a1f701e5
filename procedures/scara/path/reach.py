"""Positions of a path that seem to be in another unit than mm."""

from contextlib import suppress
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import Hand, inverse

_UNITS_MM: Final = {"m": 1e3, "inches": 25.4, "cm": 10.0, "µm": 1e-3}
"""What makes mm of other units."""


def likely_unit(place_mm: NDArray[np.float64], nominal: tuple[float, float], hand: Hand) -> str | None:
    """Return the unit in which the arm reaches all positions, if it reaches none of them in mm.

    Args:
        place_mm: positions, shape (n, 2).
        nominal: nominal links, mm.
        hand: "right" has θ2 >= 0.
    """
    radius = np.hypot(*place_mm.T)
    if np.any((radius >= abs(nominal[0] - nominal[1])) & (radius <= sum(nominal))):
        return None
    for unit, factor in _UNITS_MM.items():
        with suppress(OutOfReachError):
            inverse(factor * place_mm, *nominal, hand)
            return unit
    return None


def unit_text(what: str, unit: str) -> str:
    """Return what is wrong with positions in another unit.

    Args:
        what: which positions: "in x_mm, y_mm".
    """
    return (
        f"the positions {what} seem to be in {unit}: the arm reaches none of them in mm and all of them in {unit}; "
        "convert them to mm"
    )
