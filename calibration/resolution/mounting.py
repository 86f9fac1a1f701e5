"""Which way a count grows: that of optics follows from how somebody has mounted them, and steps show it."""

from collections.abc import Iterable

import numpy as np

from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.plateaus import plateaus
from catseye.calibration.resolution.recording import Recording

_OPPOSITE = -0.5
"""Correlation of steps with commands below which they go the other way; that of thirty steps of noise seldom is."""


def other_way_round(series: Iterable[tuple[Recording, Moves]]) -> bool:
    """Return whether positions fall where the commands grow, in all series of one mounting together.

    Large steps, which every joint follows, outweigh small ones, which may be noise.

    Args:
        series: recordings in one unit, each with its moves.

    Raises:
        MovesError: a recording does not cover its moves.
    """
    measured, command = (
        np.concatenate(parts)
        for parts in zip(
            *((np.diff(plateaus(recording, moves).mean), moves.command) for recording, moves in series),
            strict=True,
        )
    )
    known = np.isfinite(measured)
    product = float(measured[known] @ command[known])
    return product < _OPPOSITE * float(np.linalg.norm(measured[known]) * np.linalg.norm(command[known]))
