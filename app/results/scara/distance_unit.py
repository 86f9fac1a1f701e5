"""Whether distances of a file are in mm: the rough places of the reflectors give about how they change."""

from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Points
from catseye.procedures.scara.bench import ScaraBench

_UNITS = {1e3: "µm", 0.1: "cm", 1e-3: "m", 1.0 / 25.4: "inches", 25.4: "mm that were taken for inches"}
"""Names by what the distances are multiples of."""

_UNIT_SHARE = 0.1
"""Rough places (20 mm of some 500) change the ratio by a few percent; units differ by more than twice."""

_FEWEST = 4
"""Distances of a dead path that can show anything."""


def require_millimetres(file: Path, points: Points, bench: ScaraBench) -> None:
    """Refuse distances in another unit or of reversed sign.

    No fit finds it out: scaled distances are those of a scaled arm.

    Args:
        file: where the distances come from, for the complaint.

    Raises:
        UsageError: the distances are another unit's multiple of those expected from the rough places.
    """
    expected, found = _changes_mm(points, bench)
    if expected.size < _FEWEST or not (expected.any() and found.any()):
        return
    ratio = float(np.linalg.norm(found) / np.linalg.norm(expected))
    like = float(found @ expected) / float(np.linalg.norm(found) * np.linalg.norm(expected))
    unit = next((name for factor, name in _UNITS.items() if abs(ratio / factor - 1.0) <= _UNIT_SHARE), "")
    if unit and abs(like) > 1.0 - _UNIT_SHARE:
        raise UsageError(
            f"{file}: displacement_mm changes {ratio:.4g} times as much as the rough places of the reflectors let "
            f"expect: the values seem to be in {unit}: convert them to mm"
        )
    if like < -1.0 + _UNIT_SHARE:
        raise UsageError(
            f"{file}: displacement_mm falls where the beam grows longer by the rough places of the reflectors: "
            "reverse its sign, or correct the places in the cell file"
        )


def _changes_mm(points: Points, bench: ScaraBench) -> tuple[Floats, Floats]:
    """Return expected and found distances, each less the mean of its dead path, mm, shape (n,) each."""
    places = {reflector.name: reflector.xy_mm for reflector in bench.reflectors}
    reflectors = np.array([places[name] for name in points.reflector_names])
    commands = points.commands
    axis = forward(commands.theta1_rad, commands.theta2_rad, bench.link1_mm, bench.link2_mm)
    length = np.linalg.norm(axis - reflectors[points.reflector], axis=1)
    return _centred(length, points), _centred(points.displacement_mm, points)


def _centred(values: Floats, points: Points) -> Floats:
    count = np.maximum(np.bincount(points.dead_path, minlength=len(points.dead_paths)), 1)
    means = np.bincount(points.dead_path, values, minlength=len(points.dead_paths)) / count
    return np.asarray(values - means[points.dead_path], dtype=np.float64)
