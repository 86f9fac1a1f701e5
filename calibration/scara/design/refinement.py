"""Moving chosen places off the grid: a compass search that keeps every constraint."""

from collections.abc import Callable

import numpy as np

from catseye.calibration.core.arguments import require_positive
from catseye.calibration.core.types import Floats

_DIRECTIONS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]], dtype=float)

_FINEST_MM = 1.0
"""Last step; places stay multiples of it apart."""


def refine(places_mm: Floats, value: Callable[[Floats], float], step_mm: float) -> tuple[Floats, float]:
    """Improve a layout by moving one reflector at a time in eight directions, with ever smaller steps.

    Args:
        places_mm: layout, mm, shape (k, 2).
        value: criterion of a layout; infinite where it breaks a constraint.
        step_mm: first step; the last one is 1 mm.

    Returns:
        The layout and its value, which is never above that of the start.

    Raises:
        ArgumentError: the step is not positive.
    """
    require_positive(step_mm, "step_mm")
    places, best = places_mm.copy(), value(places_mm)
    step = max(_FINEST_MM, float(np.ceil(step_mm / _FINEST_MM)) * _FINEST_MM)
    while True:
        moved = False
        for k in range(len(places)):
            for direction in _DIRECTIONS:
                trial = places.copy()
                trial[k] += step * direction
                reached = value(trial)
                if reached < best:
                    places, best, moved = trial, reached, True
        if moved:
            continue
        if step <= _FINEST_MM:
            return places, best
        step = max(_FINEST_MM, float(np.floor(0.5 * step / _FINEST_MM)) * _FINEST_MM)
