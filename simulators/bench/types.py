"""Array types of the bench. Plane positions are complex numbers: x + iy, mm."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.core.types import Bools, Floats, Ints

Plane = NDArray[np.complex128]
"""Positions or directions in the plane."""

__all__ = ["Bools", "Floats", "Ints", "Plane"]
