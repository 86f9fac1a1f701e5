"""Where the uncertainties of an identified arm come from, and its Monte Carlo."""

from dataclasses import replace

import numpy as np

from catseye.calibration.core.batched_solver import BatchedProblem
from catseye.calibration.core.budget import RowErrors
from catseye.calibration.core.contributions import Contributions, row_errors, taken_apart
from catseye.calibration.core.draws import Chunk, chunked, joined, require_spread, solve_chunk
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.batched_distances import BatchedDistances
from catseye.calibration.scara.identification import Identification


def distance_errors(identified: Identification) -> RowErrors:
    """Return the errors of the distances that an identification's uncertainties come from."""
    return row_errors(identified.model, identified.parameters, identified.fit)


def contributions(identified: Identification) -> Contributions:
    """Take the covariance of an identification apart; the sum is that of the law of propagation."""
    model, values = identified.model, identified.parameters
    return taken_apart(model, values, row_errors(model, values, identified.fit))


def chunks(identified: Identification, draws: int, seed: int) -> list[Chunk]:
    """Return the work of a Monte Carlo.

    Args:
        draws: how many draws, at least 2.

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    errors = distance_errors(identified)
    require_spread(errors)
    problem = BatchedProblem.of(BatchedDistances.of(identified.model), identified.parameters)
    return chunked(problem, errors, draws, seed)


def draw_estimates(identified: Identification, draws: int, seed: int) -> Floats:
    """Draw errors from the whole budget and identify every draw anew.

    Args:
        draws: how many, at least 2.

    Returns:
        Estimates, one row a draw, shape (draws, p).

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    return joined([solve_chunk(chunk) for chunk in chunks(identified, draws, seed)]).parameters


def with_draws(identified: Identification, parameters: Floats) -> Identification:
    """Return an identification whose covariance is that of draws.

    Args:
        parameters: one row a draw, shape (draws, p).
    """
    return replace(identified, covariance=np.cov(parameters, rowvar=False))
