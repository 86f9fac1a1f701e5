"""Height and orientation of the tool along a path: what the planar error map does not correct is kept as it is."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Range
from catseye.procedures.scara.path_lines import stretches

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class ToolZero:
    """How height and orientation of a path file are counted.

    Attributes:
        z_mm: height at J3 = 0.
        c_deg: orientation where J1, J2 and J4 are 0.
        z_sign: 1 where the height grows with J3, else -1.
        c_sign: 1 where the orientation grows with J4, else -1.
    """

    z_mm: float = 0.0
    c_deg: float = 0.0
    z_sign: int = 1
    c_sign: int = 1

    def j3_mm(self, z_mm: Floats) -> Floats:
        """Return J3 at heights, mm, shape (n,)."""
        return np.asarray(self.z_sign * (z_mm - self.z_mm), dtype=np.float64)

    def j4_deg(self, c_deg: Floats, theta_deg: Floats, line: Ints, limits_deg: Range) -> Floats:
        """Return the J4 that keeps the tool's orientation in the world, c = θ1 + θ2 + J4, deg, shape (n,).

        Along a line J4 turns without jumps, by those whole turns that keep it nearest to the middle of its range.

        Args:
            c_deg: orientations, shape (n,).
            theta_deg: J1 and J2, shape (n, 2).
            line: number of the line of each row, shape (n,).
        """
        turned = self.c_sign * (c_deg - self.c_deg - theta_deg.sum(axis=1))
        middle = 0.5 * sum(limits_deg)
        for rows in stretches(line):
            along = np.unwrap(turned[rows], period=360.0)
            off = 0.5 * (along.min() + along.max()) - middle
            turned[rows] = along - 360.0 * np.round(off / 360.0)
        return np.asarray(turned, dtype=np.float64)


AS_THE_JOINTS: Final = ToolZero()
"""Heights as J3 counts, orientations as θ1 + θ2 + J4."""
