"""Reversal error from a file of target deviations (`.rtl`, `.rta`): no recording, but targets seen both ways."""

import math
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.target_deviations import TargetDeviations, read_target_deviations
from catseye.app.results.resolution.result import Reversal, Unit
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.standards.iso230_2 import Positioning, positioning

DeviationUnit: TypeAlias = Literal["um", "mrad", "urad", "arcsec", "mdeg"]

_DEG: Final = math.degrees(1.0)
_WORTH: Final[dict[DeviationUnit, float]] = {
    "mrad": 1e-3 * _DEG,
    "urad": 1e-6 * _DEG,
    "arcsec": 1.0 / 3600.0,
    "mdeg": 1e-3,
}
_UM: Final = 1e-3


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
    sides = _positioning(path, found, worth, inner)
    # Odd runs go from the first target to the last one, which may be downwards.
    upwards = _sense(path, found.target)
    repeats = len(found.forward), len(found.backward)
    variance = sides.s_up**2 / repeats[0] + sides.s_down**2 / repeats[1]
    u = float(np.sqrt(variance.sum())) / variance.size
    places = zip(found.target[inner].tolist(), (-upwards * sides.reversal).tolist(), strict=True)
    targets = [{"position": place, "reversal": lost} for place, lost in places]
    value = -upwards * float(sides.reversal.mean())
    return "mm" if linear else "deg", Reversal(value=value, u=u, valid=None), targets


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


def _positioning(path: Path, found: TargetDeviations, worth: float, inner: slice) -> Positioning:
    try:
        return positioning(worth * found.forward.T[inner], worth * found.backward.T[inner])
    except CalibrationError as error:
        raise UsageError(f"{path}: {error}") from error
