"""What every test of a result says of its steps: moves, staircase, flags; angles in degrees."""

import math
from typing import Any, Final

import numpy as np

from catseye.app.results.resolution.result import Unit
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.steps import Steps
from catseye.calibration.resolution.units import Unit as InsideUnit

_DRAWN: Final = 2000
"""Samples of a recording that a drawing needs."""


def unit_of(inside: InsideUnit) -> Unit:
    """Return the unit of files for that of calculations."""
    return "deg" if inside == "rad" else "mm"


def outside(inside: InsideUnit) -> float:
    """Return what turns lengths and angles of calculations into those of files."""
    return math.degrees(1.0) if inside == "rad" else 1.0


def move_rows(found: Steps) -> list[dict[str, Any]]:
    """Return what was commanded and measured, a row a move."""
    scale = outside(found.moves.unit)
    columns = zip(
        (scale * found.moves.command).tolist(),
        map(or_none, (scale * found.measured).tolist()),
        map(or_none, (scale * found.u).tolist()),
        map(or_none, found.error_percent.tolist()),
        found.judged.tolist(),
        strict=True,
    )
    return [
        {"command": command, "measured": measured, "u": u, "error_percent": error, "judged": judged}
        for command, measured, u, error, judged in columns
    ]


def staircase(recording: Recording, found: Steps) -> dict[str, Any]:
    """Return the recording of the test, thinned out, and its plateaus."""
    scale, rests = outside(recording.unit), found.plateaus
    end_s = float(rests.start_s[-1]) + rests.length_s
    clip, there = recording.clipped(float(rests.start_s[0]), end_s), np.isfinite(rests.mean)
    kept = np.unique(np.linspace(0, clip.position.size - 1, min(_DRAWN, clip.position.size)).astype(np.int64))
    return {
        "t_s": _rounded(clip.time_s()[kept], 4),
        "position": _rounded(scale * clip.position[kept], 9),
        "plateau_t_s": _rounded(rests.middle_s[there], 4),
        "plateau": _rounded(scale * rests.mean[there], 9),
        "plateau_s": rests.length_s,
    }


def duration_s(found: Steps) -> float:
    """Return how long a series took, from its first move to the end of its last plateau, s."""
    return float(found.plateaus.start_s[-1] + found.plateaus.length_s - found.moves.time_s[0])


def or_none(value: float) -> float | None:
    """Return a number as result files have it: None for one that is not known."""
    return value if math.isfinite(value) else None


def _rounded(values: Floats, decimals: int) -> list[float]:
    rounded: list[float] = np.round(values, decimals).tolist()
    return rounded
