"""Which distances cross-validation leaves out together: a reflector, a segment, or a sweep."""

from typing import Literal

import numpy as np

from catseye.calibration.core import cross_validation as core
from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.cross_validation import CrossValidation, Folds
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.diagnostics.joint_angles import levels
from catseye.calibration.scara.diagnostics.projection import DistanceProjection
from catseye.calibration.scara.points import Points

Way = Literal["reflector", "segment", "sweep"]


def cross_validation(projection: DistanceProjection, way: Way) -> CrossValidation:
    """Leave out each reflector, segment or sweep in turn.

    A sweep is a movement of J2 one way, at all reflectors: commands with one and the same θ1 and the same directions
    of both joints. Where θ1 moves too, as in a scan, its stretches of 10° take the place of its angles.

    Args:
        projection: the fit, on the space that its model cannot reach.
    """
    return core.cross_validation(projection, _folds(projection.points, way))


def predicted_residuals(projection: DistanceProjection, way: Way) -> Floats:
    """Return what the others predict of each distance minus what was measured, mm, shape (n,).

    NaN where the others do not determine what all have in common.
    """
    return core.predicted_residuals(projection, _folds(projection.points, way))


def _folds(points: Points, way: Way) -> Folds:
    require_one_of(Way, way, "way to leave something out")
    names, group = _groups(points, way)
    # Places, and dead paths, that no distance outside of a fold sees are the fold's own.
    own = 2 * _alone(points.reflector, group, len(names)) + _alone(points.dead_path, group, len(names))
    return Folds(way, tuple(names), group, own)


def _alone(number: Ints, group: Ints, folds: int) -> Ints:
    """Return of how many numbers each fold has all rows, shape (folds,)."""
    value, fold = np.divmod(np.unique(number * folds + group), folds)
    single = np.bincount(value)[value] == 1
    return np.bincount(fold[single], minlength=folds).astype(np.int64)


def _groups(points: Points, way: Way) -> tuple[list[str], Ints]:
    """Return the folds' names and the number of each row's fold, shape (n,)."""
    if way == "reflector":
        return [f"reflector {name}" for name in points.reflector_names], points.reflector
    if way == "segment":
        return [f"segment {number} of {name}" for name, number in points.dead_paths], points.dead_path
    commands = points.commands
    keys = np.column_stack([levels(commands.theta1_rad), commands.direction1, commands.direction2])
    distinct, number = np.unique(keys, axis=0, return_inverse=True)
    group, signs = np.asarray(np.ravel(number), dtype=np.int64), {1: "+", -1: "−"}
    theta1_deg = np.round(np.rad2deg(commands.theta1_rad), 6)
    names = [
        f"θ1 = {_span(theta1_deg[group == i])} ({signs[one]}), J2 {signs[two]}"
        for i, (_, one, two) in enumerate(distinct.tolist())
    ]
    return names, group


def _span(angle_deg: Floats) -> str:
    low, high = float(angle_deg.min()), float(angle_deg.max())
    return f"{low:g}°" if low == high else f"{low:.0f}°…{high:.0f}°"
