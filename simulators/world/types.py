"""Types of the bench. Plane positions are complex numbers: x + iy, mm."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.simulators.config import Joints

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

Plane = NDArray[np.complex128]
"""Positions or directions in the plane."""


@dataclass(frozen=True)
class TrueState:
    """What nobody on a real bench could know.

    Attributes:
        axis_mm: true position of the axis that turns the beam (x, y), mm.
        joints: what the joints really are, deg or mm.
        beam_deg: true world direction of the beam, deg.
        play: states of the play of the joints that have any, -1...1.
        reflector: name of the reflector that returns the beam, None without a return.
        nearest: name of the reflector that is missed least.
        miss_mm: distance of its centre from the beam's line, mm.
        length_mm: true length of the beam to it, mm.
    """

    axis_mm: tuple[float, float]
    joints: Joints
    beam_deg: float
    play: tuple[float, ...]
    reflector: str | None
    nearest: str
    miss_mm: float
    length_mm: float
