"""Monte Carlo of an identification: errors drawn from all that is stated, every draw identified anew (JCGM 101)."""

from dataclasses import replace

import numpy as np

from catseye.calibration.core.batched_solver import BatchedProblem, Solved
from catseye.calibration.core.contributions import row_errors
from catseye.calibration.core.draws import Chunk, chunked, joined, require_spread, solve_chunk
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.batched_rows import BatchedArm
from catseye.calibration.serial_arm.identification import Calibration


def chunks(found: Calibration, draws: int, seed: int) -> list[Chunk]:
    """Return the work of a Monte Carlo.

    Args:
        draws: how many, at least 2.

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    model, values = found.model, found.estimate.values
    errors = row_errors(model, values, found.estimate.fit)
    require_spread(errors)
    return chunked(BatchedProblem.of(BatchedArm(model), values), errors, draws, seed)


def draw_estimates(found: Calibration, draws: int, seed: int) -> Solved:
    """Identify as many draws, one row each, shape (draws, p).

    Raises:
        CalibrationError: as of `chunks`.
    """
    return joined([solve_chunk(chunk) for chunk in chunks(found, draws, seed)])


def with_draws(found: Calibration, parameters: Floats) -> Calibration:
    """Return an identification whose covariance is that of draws of shape (draws, p)."""
    covariance = np.cov(parameters, rowvar=False).reshape(parameters.shape[1], -1)
    return replace(found, estimate=replace(found.estimate, covariance=covariance))
