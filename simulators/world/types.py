"""Array types of the bench. Plane positions are complex numbers: x + iy, mm."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

Plane = NDArray[np.complex128]
"""Positions or directions in the plane."""
