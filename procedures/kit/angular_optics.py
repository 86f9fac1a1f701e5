"""What angular optics say; light, since the first screen imports it."""

import math


def angle_deg(displacement_mm: float, spacing_mm: float) -> float | None:
    """Return the angle that angular optics have turned by, deg; None beyond a right angle: θ = arcsin(ΔL / S)."""
    share = displacement_mm / spacing_mm
    return math.degrees(math.asin(share)) if abs(share) <= 1.0 else None
