"""How uncertain rows are that do not say it: as much as those of the calibration scatter."""

import math
from dataclasses import replace

import numpy as np

from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.serial_arm.measurements import Measurements

_LEAST_MM = 1e-9
"""Rows of simulations scatter by less than any instrument can show."""


def states_compared(rows: Measurements) -> bool:
    """Return whether the rows that an arm is compared with, places or else distances, state their uncertainties."""
    return (rows.points.covariance_mm2 if len(rows.points.pose) else rows.distances.u_mm) is not None


def row_scatter_mm(result: SerialArmResult, *, of_distances: bool) -> float | None:
    """Return the standard deviation of a coordinate, or of a length, beside what single poses are missed by.

    Returns:
        None where the calibration had other rows than these alone, or bore wrong ones by a robust loss: its residuals
            say nothing of them then.
    """
    if result.loss != "squares":
        return None
    had_places = not result.anchors or bool(result.errors and result.errors.pose)
    if bool(result.anchors) != of_distances or had_places == of_distances:
        return None
    free = result.fit.n_rows - result.fit.n_parameters
    scatter_mm2 = result.fit.rms_mm**2 * result.fit.n_rows / max(free, 1)
    return max(math.sqrt(max(scatter_mm2 - (result.left_mm or 0.0) ** 2, 0.0)), _LEAST_MM)


def stating(rows: Measurements, u_mm: float) -> Measurements:
    """Return rows that state one uncertainty each.

    Args:
        u_mm: of each coordinate of a place, or of each distance.
    """
    count = len(rows.points.pose)
    points = replace(rows.points, covariance_mm2=np.tile(u_mm**2 * np.eye(3), (count, 1, 1)))
    return replace(
        rows, points=points, distances=replace(rows.distances, u_mm=np.full(len(rows.distances.pose), u_mm))
    )
