"""Coverage: factors and degrees of freedom (GUM), intervals from draws and the test of calculated ones (JCGM 101)."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import special
from scipy.sparse import csgraph

from catseye.calibration.core.arguments import (
    require_count,
    require_finite,
    require_positive,
    require_shape,
    require_share,
)
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats, Ints

Verdict = Literal["validated", "not validated", "too few draws"]


@dataclass(frozen=True)
class Interval:
    """Limits that a quantity lies between with a coverage probability."""

    low: float
    high: float


def symmetric_interval(draws: Floats, coverage: float) -> Interval:
    """Return the interval with equal probability on either side.

    Args:
        draws: of one quantity, shape (draws,).
        coverage: 0...1.
    """
    ordered, count = _ordered(draws, coverage)
    first = (ordered.size - count + 1) // 2
    return Interval(float(ordered[first - 1]), float(ordered[first - 1 + count]))


def shortest_interval(draws: Floats, coverage: float) -> Interval:
    """Return the shortest interval that holds the share `coverage` of the draws."""
    ordered, count = _ordered(draws, coverage)
    first = int(np.argmin(ordered[count:] - ordered[:-count]))
    return Interval(float(ordered[first]), float(ordered[first + count]))


def fewest_draws(coverage: float) -> int:
    """Return the draws below which an interval's limits are not worth stating: 100/(1 − p).

    Then fifty draws lie beyond either limit of a symmetric interval.
    """
    require_share(coverage, "coverage")
    return math.ceil(100.0 / (1.0 - coverage) - 1e-9)


def numerical_tolerance(u: float, digits: int = 1) -> float:
    """Return half a unit of the last digit of a standard uncertainty that is stated with so many digits."""
    require_count(digits, "digits")
    if not (u > 0.0 and math.isfinite(u)):
        return 0.0
    exponent = int(f"{u:.{digits - 1}e}".partition("e")[2]) - (digits - 1)
    return 0.5 * 10.0**exponent


@dataclass(frozen=True)
class Validation:
    """A calculated interval against that of draws.

    Attributes:
        calculated: interval of the law of propagation.
        drawn: probabilistically symmetric interval of the draws.
        tolerance: largest difference of the limits that counts as agreement.
        sampling: what chance leaves open of the drawn limits (two standard deviations).
    """

    calculated: Interval
    drawn: Interval
    tolerance: float
    sampling: float

    @property
    def difference(self) -> float:
        """Larger difference of the limits."""
        return max(
            abs(self.calculated.low - self.drawn.low),
            abs(self.calculated.high - self.drawn.high),
        )

    @property
    def verdict(self) -> Verdict:
        """Whether the law of propagation may be used, as far as the draws show."""
        if self.difference <= self.tolerance:
            return "validated"
        return "not validated" if self.difference > self.tolerance + self.sampling else "too few draws"


def validate(calculated: Interval, draws: Floats, coverage: float, u: float, digits: int = 1) -> Validation:
    """Test a calculated interval.

    Args:
        calculated: interval of the law of propagation at the same coverage.
        draws: of the quantity, shape (draws,).
        coverage: 0...1.
        u: standard uncertainty, which sets the tolerance.
        digits: significant digits that it is stated with.
    """
    drawn = symmetric_interval(draws, coverage)
    sampling = 2.0 * max(_scatter(draws, share) for share in (0.5 * (1.0 - coverage), 0.5 * (1.0 + coverage)))
    return Validation(calculated, drawn, numerical_tolerance(u, digits), sampling)


def _scatter(draws: Floats, share: float) -> float:
    """Return the standard deviation of a quantile, from the binomial spread of its rank."""
    spread = math.sqrt(share * (1.0 - share) / draws.size)
    low, high = np.quantile(draws, np.clip([share - spread, share + spread], 0.0, 1.0))
    return 0.5 * float(high - low)


def _ordered(draws: Floats, coverage: float) -> tuple[Floats, int]:
    """Return draws in ascending order, and how many of them an interval holds."""
    require_shape(draws, (None,), "draws")
    require_finite(draws, "draws")
    require_share(coverage, "coverage")
    count = int(coverage * draws.size + 0.5)
    if not 0 < count < draws.size:
        raise ArgumentError(f"{draws.size} draws hold no interval of coverage {coverage:g}: draw more")
    return np.sort(draws), count


def effective_dof(parts: Floats, dof: Floats, correlations: Floats | None = None) -> float:
    """Return the effective degrees of freedom of a combined standard uncertainty (Welch–Satterthwaite, GUM G.4.1).

    The formula holds for independent inputs. Correlated ones were estimated together, from one set of observations or
    by one fit: they count as one input with the degrees of freedom that they have in common, and with the standard
    uncertainty that they give the result together.

    Args:
        parts: sensitivity times standard uncertainty of each input, with its sign, shape (k,).
        dof: degrees of freedom of each, infinite where it is known for certain, shape (k,).
        correlations: coefficients between the inputs, shape (k, k); None where they are independent.

    Raises:
        ArgumentError: correlated inputs have different degrees of freedom, or some are not positive.
    """
    parts, dof = np.asarray(parts, dtype=np.float64), np.asarray(dof, dtype=np.float64)
    require_shape(dof, parts.shape, "dof")
    require_positive(dof, "dof", infinite=True)
    if correlations is None:
        together, joined = np.arange(parts.size), parts
    else:
        require_shape(correlations, (parts.size, parts.size), "correlations")
        together = csgraph.connected_components(correlations != 0.0, directed=False)[1].astype(np.int64)
        _require_one_dof(dof, together)
        joined = correlations @ parts
    variances = np.bincount(together, parts * joined)
    total = float(variances.sum())
    if total <= 0.0:
        return math.inf
    inverse = float(np.sum((variances / total) ** 2 / dof[np.unique(together, return_index=True)[1]]))
    return 1.0 / inverse if inverse > 0.0 else math.inf


def _require_one_dof(dof: Floats, together: Ints) -> None:
    for number in np.unique(together):
        own = np.unique(dof[together == number])
        if own.size > 1:
            listed = ", ".join(f"{one:g}" for one in own)
            raise ArgumentError(
                f"correlated inputs have {listed} degrees of freedom: correlation comes from an estimate that they "
                "share, and with it its degrees of freedom; state the same for all of them"
            )


def coverage_factor(coverage: float, dof: Floats | float) -> Floats:
    """Return the factor k that makes an expanded of a standard uncertainty.

    Args:
        coverage: probability that the interval holds the quantity, 0...1.
        dof: effective degrees of freedom, infinite for a normal distribution, any shape.
    """
    require_share(coverage, "coverage")
    require_positive(dof, "dof", infinite=True)
    return np.asarray(special.stdtrit(dof, 0.5 * (1.0 + coverage)), dtype=np.float64)


def correlation(covariance: Floats) -> Floats:
    """Return the correlation matrix; quantities without uncertainty are correlated with nothing."""
    u = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    safe = np.where(u > 0.0, u, 1.0)
    matrix = np.asarray(covariance / np.outer(safe, safe), dtype=np.float64)
    np.fill_diagonal(matrix, 1.0)
    return matrix
