"""Monte Carlo of an estimate: errors drawn from the whole budget, every draw estimated anew (JCGM 101).

Draws come in chunks, each with a seed of its own, so that they are the same however many processes share them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_count
from catseye.calibration.core.batched_solver import BatchedProblem, Solved, solve_draws
from catseye.calibration.core.budget import RowErrors
from catseye.calibration.core.errors import CalibrationError

CHUNK = 250
"""Draws of a chunk; the numbers that a seed gives depend on it."""

_BATCH_NUMBERS = 28_000
"""Rows drawn and solved at once: their arrays (200 kB each) stay in the cache."""

_EXACT_MM = 1e-9
"""Uncertainties below this are rounding, not measurement."""


@dataclass(frozen=True)
class Chunk:
    """Some of the draws, with all that is needed to carry them out elsewhere.

    Attributes:
        problem: what all draws have in common.
        errors: what is drawn.
        number: of the chunk, counting from 0.
        draws: how many.
    """

    problem: BatchedProblem
    errors: RowErrors
    seed: int
    number: int
    draws: int


def chunked(problem: BatchedProblem, errors: RowErrors, draws: int, seed: int) -> list[Chunk]:
    """Return the work of a Monte Carlo of so many draws, at least 2.

    Raises:
        ArgumentError: fewer draws, or a negative seed.
    """
    require_count(draws, "draws", 2)
    require_count(seed, "seed", 0)
    starts = range(0, draws, CHUNK)
    return [Chunk(problem, errors, seed, k, min(CHUNK, draws - start)) for k, start in enumerate(starts)]


def solve_chunk(chunk: Chunk) -> Solved:
    """Draw and estimate a chunk."""
    seed = np.random.SeedSequence(chunk.seed, spawn_key=(chunk.number,))
    # A fifth faster than the default generator at what takes a third of a draw's time: normal numbers.
    rng = np.random.Generator(np.random.SFC64(seed))
    most = max(1, _BATCH_NUMBERS // chunk.problem.predicted_mm.size)
    batches = [min(most, chunk.draws - first) for first in range(0, chunk.draws, most)]
    return joined([solve_draws(chunk.problem, chunk.errors.draw(rng, draws)) for draws in batches])


def joined(solved: Sequence[Solved]) -> Solved:
    """Return chunks, given in their order, as one."""
    return Solved(np.concatenate([one.parameters for one in solved]), sum(one.fallbacks for one in solved))


def require_spread(errors: RowErrors) -> None:
    """Refuse errors that draws cannot settle.

    Raises:
        CalibrationError: a distribution has no standard deviation, or nothing is uncertain.
    """
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
            "values again and again; state what the distances are good for, in the cell file's [uncertainty] or "
            "in the column sigma_mm"
        )
