"""Which distances cross-validation leaves out together: a reflector, a segment, or a sweep."""

from typing import Literal

import numpy as np

from catseye.calibration.core import cross_validation as core
from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.cross_validation import CrossValidation, Folds
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.diagnostics.projection import DistanceProjection
from catseye.calibration.scara.points import Points

Way = Literal["reflector", "segment", "sweep"]


def cross_validation(projection: DistanceProjection, way: Way) -> CrossValidation:
    """Leave out each reflector, segment or sweep in turn.

    A sweep is an unbroken row of commands of all reflectors with one and the same θ1 and the same directions of both
    joints: a movement of J2 one way.

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
    own = [_own_parameters(points, group == i) for i in range(len(names))]
    return Folds(way, tuple(names), group, np.array(own, dtype=np.int64))


def _own_parameters(points: Points, rows: Bools) -> int:
    """Return how many parameters are the fold's own: places and dead paths that no other distance sees."""
    places = np.setdiff1d(points.reflector[rows], points.reflector[~rows]).size
    return 2 * places + int(np.setdiff1d(points.dead_path[rows], points.dead_path[~rows]).size)


def _groups(points: Points, way: Way) -> tuple[list[str], Ints]:
    """Return the folds' names and the number of each row's fold, shape (n,)."""
    if way == "reflector":
        return [f"reflector {name}" for name in points.reflector_names], points.reflector
    if way == "segment":
        return [f"segment {number} of {name}" for name, number in points.dead_paths], points.dead_path
    commands = points.commands
    keys = np.column_stack([np.round(commands.theta1_rad, 9), commands.direction1, commands.direction2])
    distinct, number = np.unique(keys, axis=0, return_inverse=True)
    signs = {1: "+", -1: "−"}
    names = [
        f"θ1 = {round(float(np.rad2deg(angle)), 6):g}° ({signs[int(one)]}), J2 {signs[int(two)]}"
        for angle, one, two in distinct.tolist()
    ]
    return names, np.asarray(np.ravel(number), dtype=np.int64)
