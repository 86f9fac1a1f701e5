"""How far an identified arm may be from what was known of it before."""

import math
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Bounds:
    """Largest differences that an arm which was measured and described correctly may have.

    Attributes:
        deviation_rad: of a joint's angle from its command.
        link_mm: of a link from its nominal length.
        place_mm: of a reflector from its rough place.
    """

    deviation_rad: float = math.radians(1.0)
    link_mm: float = 2.0
    place_mm: float = 100.0


BOUNDS: Final = Bounds()
"""Those of an arm and a bench of which nothing else is known."""
