"""Angles and lengths are evaluated alike; only texts have to know which of them they tell."""

import math
from typing import Literal

Unit = Literal["rad", "mm"]
"""Unit of a position: of a joint or about an axis, or along one."""


def shown(value: float, unit: Unit) -> str:
    """Return a position or a step as a text states it: angles in degrees."""
    return f"{math.degrees(value):.3g}°" if unit == "rad" else f"{value:.3g} mm"
