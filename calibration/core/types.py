"""Array types used throughout the calibration room."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Array of double precision numbers; shapes are stated where it is used."""

Ints = NDArray[np.int64]
"""Array of indices or of directions (1 or -1)."""

Bools = NDArray[np.bool_]
"""Array of flags."""
