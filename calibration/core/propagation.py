"""The law of propagation of uncertainty with correlations (GUM)."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.distributions import DIVISORS, Shape
from catseye.calibration.core.types import Floats

_STEP = 1e-3
"""Share of a standard uncertainty that an input is moved by for a sensitivity coefficient."""


@dataclass(frozen=True)
class Inputs:
    """Estimates of input quantities.

    Attributes:
        values: estimates, shape (k,).
        covariance: of the estimates, shape (k, k).
        dof: degrees of freedom of each standard uncertainty, shape (k,).
    """

    values: Floats
    covariance: Floats
    dof: Floats

    @property
    def u(self) -> Floats:
        """Standard uncertainties, shape (k,)."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class Outputs:
    """Results of one measurement model.

    Attributes:
        values: estimates, shape (m,).
        covariance: of the results; those that share inputs are correlated, shape (m, m).
        dof: effective degrees of freedom of each combined standard uncertainty, shape (m,); those of correlated
            inputs hold only as far as the inputs were uncorrelated.
    """

    values: Floats
    covariance: Floats
    dof: Floats

    @property
    def u(self) -> Floats:
        """Combined standard uncertainties, shape (m,)."""
        return np.sqrt(np.diag(self.covariance))

    def expanded(self, coverage: float) -> Floats:
        """Return the expanded uncertainties at a coverage probability, shape (m,)."""
        return self.u * coverage_factor(coverage, self.dof)


def type_a(readings: Floats) -> Inputs:
    """Evaluate repeated readings; those of one column were taken together and may be correlated.

    Args:
        readings: at least two repeats as columns, shape (k, n) or (n,).
    """
    rows = np.atleast_2d(readings)
    repeats = rows.shape[1]
    if repeats < 2:
        raise ValueError("a Type A evaluation needs at least two readings")
    covariance = np.atleast_2d(np.cov(rows)) / repeats
    return Inputs(rows.mean(axis=1), covariance, np.full(rows.shape[0], repeats - 1.0))


def type_b(half_width: float, shape: Shape) -> float:
    """Return the standard uncertainty of a half width; of a normal distribution it is given itself."""
    return half_width / DIVISORS[shape]


def independent(values: Floats, u: Floats, dof: Floats | None = None) -> Inputs:
    """Return uncorrelated inputs, with unlimited degrees of freedom unless they are told."""
    unlimited = np.full(len(values), math.inf)
    return Inputs(
        np.asarray(values, dtype=np.float64), np.diag(np.square(u)), unlimited if dof is None else dof
    )


def sensitivities(model: Callable[[Floats], Floats], inputs: Inputs) -> Floats:
    """Return the derivatives of the results by the inputs, from central differences, shape (m, k)."""
    columns = []
    for i, u in enumerate(inputs.u):
        step = np.zeros(inputs.values.size)
        # An input without uncertainty adds nothing, but its sensitivity may be asked for.
        step[i] = _STEP * (u if u > 0.0 else max(abs(float(inputs.values[i])), 1.0))
        above, below = (np.atleast_1d(model(inputs.values + sign * step)) for sign in (1.0, -1.0))
        columns.append((above - below) / (2.0 * step[i]))
    return np.stack(columns, axis=1)


def propagate(model: Callable[[Floats], Floats], inputs: Inputs) -> Outputs:
    """Propagate uncertainties through a measurement model.

    Args:
        model: results of shape (m,) or a number from inputs of shape (k,).
        inputs: estimates with their covariance.
    """
    slopes = sensitivities(model, inputs)
    covariance = slopes @ inputs.covariance @ slopes.T
    u = np.sqrt(np.diag(covariance))
    dof = np.array(
        [effective_dof(row * inputs.u, inputs.dof, total) for row, total in zip(slopes, u, strict=True)]
    )
    return Outputs(np.atleast_1d(model(inputs.values)), covariance, dof)


def effective_dof(parts: Floats, dof: Floats, combined: float | None = None) -> float:
    """Return the effective degrees of freedom of a combined standard uncertainty (Welch–Satterthwaite).

    Args:
        parts: standard uncertainty that each independent input makes of the result, shape (k,).
        dof: degrees of freedom of each, infinite where it is known for certain, shape (k,).
        combined: combined standard uncertainty; None for the root of the sum of the squares.
    """
    total = float(np.sqrt(np.sum(np.square(parts)))) if combined is None else combined
    if total == 0.0:
        return math.inf
    inverse = float(np.sum((np.asarray(parts) / total) ** 4 / np.asarray(dof)))
    return 1.0 / inverse if inverse > 0.0 else math.inf


def coverage_factor(coverage: float, dof: Floats | float) -> Floats:
    """Return the factor k that makes an expanded of a standard uncertainty.

    Args:
        coverage: probability that the interval holds the quantity, 0...1.
        dof: effective degrees of freedom, infinite for a normal distribution, any shape.
    """
    return np.asarray(special.stdtrit(dof, 0.5 * (1.0 + coverage)), dtype=np.float64)


def correlation(covariance: Floats) -> Floats:
    """Return the correlation matrix; quantities without uncertainty are correlated with nothing."""
    u = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    safe = np.where(u > 0.0, u, 1.0)
    matrix = np.asarray(covariance / np.outer(safe, safe), dtype=np.float64)
    np.fill_diagonal(matrix, 1.0)
    return matrix
