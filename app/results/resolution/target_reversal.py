"""Reversal error from a file of target deviations (`.rtl`, `.rta`): no recording, but targets seen both ways."""

import math
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.target_deviations import read_target_deviations
from catseye.app.results.resolution.result import Reversal, Unit
from catseye.calibration.core.types import Floats

DeviationUnit: TypeAlias = Literal["um", "mrad", "urad", "arcsec", "mdeg"]

_DEG: Final = math.degrees(1.0)
_WORTH: Final[dict[DeviationUnit, float]] = {
    "mrad": 1e-3 * _DEG,
    "urad": 1e-6 * _DEG,
    "arcsec": 1.0 / 3600.0,
    "mdeg": 1e-3,
}
_UM: Final = 1e-3

_FEWEST: Final = 2
"""Runs in a direction that show how they scatter."""


def is_target_file(path: Path) -> bool:
    """Return whether a file holds target deviations, by the end of its name."""
    return path.suffix.lower() in {".rtl", ".rta"}


def reversal_of_targets(
    path: Path, angular_unit: DeviationUnit | None
) -> tuple[Unit, Reversal, list[dict[str, float]]]:
    """Return the reversal error between the ends, lost motion positive (the paper, equation 2; ISO 230-2).

    Args:
        path: `.rtl`, whose deviations are in µm, or `.rta`.
        angular_unit: of the deviations of a `.rta`, which the file does not state for certain.

    Returns:
        The unit of the values, the reversal error, and each target between the ends.

    Raises:
        UsageError: the file cannot be used, has runs in one direction only, its targets have no order, or its unit is
            not stated.
    """
    found = read_target_deviations(path)
    linear = path.suffix.lower() == ".rtl"
    worth = _UM if linear else _worth(path, angular_unit)
    inner = slice(1, -1)
    if found.target.size < 3:
        raise UsageError(
            f"{path}: {found.target.size} targets have none between their ends: measure three or more"
        )
    forward, backward = worth * found.forward.T[inner], worth * found.backward.T[inner]
    if not backward.size:
        raise UsageError(
            f"{path}: its only run goes one way: a reversal error needs runs forwards and backwards"
        )
    # Odd runs go from the first target to the last one, which may be downwards.
    lost = _sense(path, found.target) * (backward.mean(axis=1) - forward.mean(axis=1))
    targets = [
        {"position": place, "reversal": one}
        for place, one in zip(found.target[inner].tolist(), lost.tolist(), strict=True)
    ]
    reversal = Reversal(value=float(lost.mean()), u=_u_of_mean(forward, backward), valid=None)
    return "mm" if linear else "deg", reversal, targets


def _u_of_mean(*sides: Floats) -> float | None:
    """Return the standard uncertainty of the mean reversal error from the repeats; None without any on a side.

    Args:
        sides: deviations of the targets, a column a run, shape (m, n) each.
    """
    if min(side.shape[1] for side in sides) < _FEWEST:
        return None
    variance = sum(float((side.var(axis=1, ddof=1) / side.shape[1]).sum()) for side in sides)
    return math.sqrt(variance) / len(sides[0])


def _sense(path: Path, targets: Floats) -> float:
    """Return 1 where positions grow from target to target, −1 where they fall."""
    senses = np.sign(np.diff(targets))
    if senses[0] == 0.0 or (senses != senses[0]).any():
        raise UsageError(
            f"{path}: the targets neither grow nor fall from one to the next: which way the runs went is not "
            "known; export the file again"
        )
    return float(senses[0])


def _worth(path: Path, unit: DeviationUnit | None) -> float:
    if unit is None or unit not in _WORTH:
        raise UsageError(
            f"{path}: the unit of its deviations is not certain; state what the laser's software shows by "
            f"--deviation-unit {'|'.join(_WORTH)}"
        )
    return _WORTH[unit]
