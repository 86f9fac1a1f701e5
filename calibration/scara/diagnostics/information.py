"""Information criteria of fits to the same distances with the same weights; the lower the better."""

import math


def aicc(square: float, distances: int, free: int) -> float:
    """Return Akaike's criterion with the correction for few distances (Hurvich and Tsai).

    Args:
        square: weighted sum of squares of the residuals.
        distances: how many, n.
        free: free parameters; the scale of the scatter counts as one more.
    """
    k = free + 1
    if distances - k - 1 < 1:
        return math.inf
    return _deviance(square, distances) + 2.0 * k + 2.0 * k * (k + 1) / (distances - k - 1)


def bic(square: float, distances: int, free: int) -> float:
    """Return Schwarz's criterion; arguments as those of `aicc`."""
    return _deviance(square, distances) + (free + 1) * math.log(distances)


def _deviance(square: float, distances: int) -> float:
    return distances * math.log(max(square, 1e-300) / distances)
