"""Propagation of distributions by draws, for any measurement model (JCGM 101)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.coverage import (
    Interval,
    fewest_draws,
    numerical_tolerance,
    shortest_interval,
    symmetric_interval,
)
from catseye.calibration.core.distributions import Distribution
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.types import Floats

Model = Callable[[Floats], Floats]
"""Result of shape (draws,), or results of shape (m, draws), from inputs of shape (k, draws)."""

_LEAST_BLOCK = 10_000


def propagate_distributions(model: Model, inputs: Sequence[Distribution], draws: int, seed: int) -> Floats:
    """Return draws of the result, shape (draws,) or (m, draws).

    Args:
        model: the measurement model.
        inputs: distribution of each input, independent of one another.
        draws: how many.
        seed: of the draws.
    """
    return _block(model, inputs, draws, np.random.default_rng(seed))


@dataclass(frozen=True)
class Stable:
    """A result whose numbers no longer change with more draws.

    Attributes:
        draws: of the result, shape (draws,).
        tolerance: half a unit of the last digit of u; twice the standard deviation of mean, u and limits is below.
        coverage: of the intervals.
    """

    draws: Floats
    tolerance: float
    coverage: float

    @property
    def mean(self) -> float:
        """Estimate."""
        return float(np.mean(self.draws))

    @property
    def u(self) -> float:
        """Standard uncertainty."""
        return float(np.std(self.draws, ddof=1))

    @property
    def symmetric(self) -> Interval:
        """Probabilistically symmetric interval."""
        return symmetric_interval(self.draws, self.coverage)

    @property
    def shortest(self) -> Interval:
        """Shortest interval."""
        return shortest_interval(self.draws, self.coverage)


def until_stable(
    model: Model,
    inputs: Sequence[Distribution],
    seed: int,
    coverage: float = 0.95,
    digits: int = 2,
    most_blocks: int = 1000,
) -> Stable:
    """Draw blocks until estimate, standard uncertainty and limits are known to the tolerance.

    Args:
        model: the measurement model, of one result.
        inputs: distribution of each input, independent of one another.
        seed: of the draws.
        coverage: of the interval.
        digits: significant digits that the standard uncertainty shall have.
        most_blocks: of draws.

    Raises:
        ConvergenceError: so many blocks do not settle it.
    """
    rng, size = np.random.default_rng(seed), max(_LEAST_BLOCK, fewest_draws(coverage))
    blocks: list[Floats] = []
    told: list[tuple[float, float, float, float]] = []
    for count in range(1, most_blocks + 1):
        blocks.append(_block(model, inputs, size, rng))
        limits = symmetric_interval(blocks[-1], coverage)
        told.append((float(blocks[-1].mean()), float(blocks[-1].std(ddof=1)), limits.low, limits.high))
        if count < 2:
            continue
        scatter = np.std(told, axis=0, ddof=1) / np.sqrt(count)
        tolerance = numerical_tolerance(float(np.std(np.concatenate(blocks), ddof=1)), digits)
        if np.all(2.0 * scatter < tolerance):
            return Stable(np.concatenate(blocks), tolerance, coverage)
    raise ConvergenceError(
        f"{most_blocks * size} draws do not settle {digits} digits of the standard uncertainty: "
        "ask for fewer digits, or look for an input whose distribution has no standard deviation"
    )


def _block(model: Model, inputs: Sequence[Distribution], draws: int, rng: np.random.Generator) -> Floats:
    drawn = np.stack([one.draw(rng, draws) for one in inputs])
    return np.asarray(model(drawn), dtype=np.float64)
