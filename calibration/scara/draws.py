"""Monte Carlo of an identification: errors drawn from the whole budget, every draw identified anew (JCGM 101).

Draws come in chunks, each with a seed of its own, so that they are the same however many processes share them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.batched_solver import BatchedProblem, Solved, solve_draws
from catseye.calibration.core.budget import DistanceErrors, distance_errors
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.identification import Identification

CHUNK = 250
"""Draws of a chunk; the numbers that a seed gives depend on it."""

_EXACT_MM = 1e-9
"""Uncertainties below this are rounding, not measurement."""


@dataclass(frozen=True)
class Chunk:
    """Some of the draws, with all that is needed to carry them out elsewhere.

    Attributes:
        problem: what all draws have in common.
        errors: what is drawn.
        seed: of all draws.
        number: of the chunk, counting from 0.
        draws: how many.
    """

    problem: BatchedProblem
    errors: DistanceErrors
    seed: int
    number: int
    draws: int


def chunks(identified: Identification, draws: int, seed: int) -> list[Chunk]:
    """Return the work of a Monte Carlo.

    Args:
        identified: what the solver returned.
        draws: how many draws, at least 2.
        seed: of the draws.

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    errors = distance_errors(identified)
    _require_spread(errors)
    problem = BatchedProblem.of(distance_model(identified.layout, identified.points), identified.parameters)
    starts = range(0, draws, CHUNK)
    return [Chunk(problem, errors, seed, k, min(CHUNK, draws - start)) for k, start in enumerate(starts)]


def solve_chunk(chunk: Chunk) -> Solved:
    """Draw and identify a chunk."""
    rng = np.random.default_rng(np.random.SeedSequence(chunk.seed, spawn_key=(chunk.number,)))
    return solve_draws(chunk.problem, chunk.errors.draw(rng, chunk.draws))


def joined(solved: Sequence[Solved]) -> Solved:
    """Return chunks, given in their order, as one."""
    return Solved(np.concatenate([one.parameters for one in solved]), sum(one.fallbacks for one in solved))


def draw_estimates(identified: Identification, draws: int, seed: int) -> Floats:
    """Draw errors from the whole budget and identify every draw anew.

    Args:
        identified: what the solver returned.
        draws: how many, at least 2.
        seed: of the draws.

    Returns:
        Estimates, one row a draw, shape (draws, p).

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
    return joined([solve_chunk(chunk) for chunk in chunks(identified, draws, seed)]).parameters


def with_draws(identified: Identification, parameters: Floats) -> Identification:
    """Return an identification whose covariance is that of draws.

    Args:
        identified: what the solver returned.
        parameters: one row a draw, shape (draws, p).
    """
    return replace(identified, covariance=np.cov(parameters, rowvar=False))


def _require_spread(errors: DistanceErrors) -> None:
    wild = [one.name for one in errors.contributors if one.dof <= 2.0]
    if wild or errors.factor_dof <= 2.0:
        raise CalibrationError(
            f"{', '.join(wild) or 'the scatter of the fit'}: a standard uncertainty with 2 or fewer degrees of "
            "freedom has a distribution without standard deviation, and draws from it settle nothing: take more "
            "readings or measure more points, or propagate by the Jacobian"
        )
    sizes = [float(np.abs(one.sigma_mm).max(initial=0.0)) for one in errors.white]
    sizes += [float(np.abs(one.effects_mm).max(initial=0.0)) for one in errors.shared]
    if math.sqrt(errors.factor) * max(sizes) < _EXACT_MM:
        raise CalibrationError(
            "nothing is uncertain: all standard uncertainties are zero, and a Monte Carlo would draw the same "
            "distances again and again; state what the distances are good for, in the cell file's [uncertainty] or "
            "in the column sigma_mm"
        )
