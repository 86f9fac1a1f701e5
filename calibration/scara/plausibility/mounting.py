"""A turn of the interferometer on J4's flange that the table does not state."""

from dataclasses import replace
from typing import Final

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.findings import MountingForgotten
from catseye.calibration.scara.points import Points

_MISFIT: Final = 2.0
"""χ² per degree of freedom below which nothing asks for an explanation."""

_LEFT: Final = 0.5
"""Share of χ² that may be left when a turn explains the distances; chance takes off a few percent."""


def forgotten_mounting(problem: Problem, found: Identification) -> MountingForgotten | None:
    """Return from where on the interferometer seems to have been turned by half a turn; None where it does not.

    Args:
        problem: that the identification solves.
    """
    points, misfit = found.points, found.fit.chi2_reduced
    row = _second_pass(points)
    if misfit is None or misfit < _MISFIT or row is None or not _shows_j4(problem):
        return None
    mount = np.where(np.arange(len(points)) < row, 0.0, np.pi)
    # Uncertainties that follow from the budget follow anew.
    sigma = None if problem.points.sigma_mm is None else points.sigma_mm
    kept = [problem.points.reflector_names.index(name) for name in points.reflector_names]
    turned = replace(
        problem,
        points=replace(points, sigma_mm=sigma, theta4_rad=None, mount_rad=mount),
        reflectors_mm=problem.reflectors_mm[kept],
    )
    try:
        left = turned.solve().fit.chi2_reduced
    except CalibrationError:
        return None
    if left is None or left > _LEFT * misfit:
        return None
    name, segment = points.dead_paths[int(points.dead_path[row])]
    return MountingForgotten(name, segment, row if found.rows is None else int(found.rows[row]))


def _shows_j4(problem: Problem) -> bool:
    return problem.model == "error-map" and problem.budget is not None and problem.budget.follows_j4


def _second_pass(points: Points) -> int | None:
    """Return the row, next to the middle, where a new segment measures what was measured before."""
    if points.mount_rad is not None and points.mount_rad.any():
        return None
    again = replace(points, dead_path=0 * points.dead_path).repeats(bidirectional=False)
    firsts = np.unique(again, return_index=True)[1][again]
    starts = np.unique(points.dead_path, return_index=True)[1]
    possible = [int(row) for row in starts if firsts[row] < row]
    return min(possible, key=lambda row: abs(2 * row - len(points)), default=None)
