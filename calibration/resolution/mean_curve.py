"""The mean of the step errors as a function of the step, from one series: a Gaussian process with growing scatter.

Errors of small steps scatter more than those of large ones, and neighbours may be correlated. The mean is smooth over
the logarithm of the step (Matérn 5/2), and what it may reach grows with the scatter: an error that is the same in
degrees for all steps is a growing share of them. How smooth and how large it is, and what neighbours share, are
integrated over, not picked. Source: Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), chapters
2 and 5; the variance of the scatter by a gamma model, as Davidian and Carroll, JASA 82 (1987) 1079.
"""

import itertools
import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats

_AMPLITUDES: Final = (1.5, 5.0, 15.0, 50.0)
"""Of the mean, over the scatter of a step."""

_LENGTHS: Final = (0.8, 1.6, 3.2, 6.4, 12.8)
"""Of the kernel, in e-folds of the step; the paper's window of 11 steps is 0.77 wide."""

_CORRELATIONS: Final = {-0.5: 0.135, -0.25: 0.607, 0.0: 1.0, 0.25: 0.607, 0.5: 0.135}
"""Of neighbours, each with its prior weight: normal with a standard deviation of 0.25.

A step starts from where the joint was measured to stand, so what the last one missed by is not in it: correlation is
possible, but none is expected.
"""

_LEVEL_PERCENT: Final = 10.0
"""Prior standard deviation of what all steps share."""

_SCALE_DOF: Final = 4.0
"""Of the prior of the scatter's scale: weak beside some hundred steps."""

_ROUNDS: Final = 8
_LEAST_PERCENT: Final = 1e-3
"""Scatter below this is rounding."""


@dataclass(frozen=True)
class _Models:
    """Covariances over that of the scatter's scale, for every point of the grid, in units of the scatter.

    Attributes:
        mean: of the mean curve, shape (k, n, n).
        noise: of the step errors about it, shape (k, n, n).
        prior: weights before the series is seen, shape (k,).
    """

    mean: Floats
    noise: Floats
    prior: Floats


def draw_mean_curves(log_step: Floats, error_percent: Floats, draws: int, rng: np.random.Generator) -> Floats:
    """Return mean curves of the step error that agree with one series, as often as they are likely.

    Args:
        log_step: natural logarithm of the commanded steps, decreasing, shape (n,).
        error_percent: E_s of each, %, shape (n,).

    Returns:
        Means at the steps, %, shape (draws, n).
    """
    scatter = scatter_percent(log_step, error_percent)
    values = error_percent / scatter
    models = _models(log_step, scatter)
    likely, squares = _posterior(models, values)
    counts = rng.multinomial(draws, likely)
    curves = [
        _draws(models.mean[k], models.noise[k], values, float(squares[k]), int(counts[k]), rng)
        for k in np.flatnonzero(counts)
    ]
    return np.asarray(np.concatenate(curves) * scatter)


def scatter_percent(log_step: Floats, error_percent: Floats) -> Floats:
    """Return the standard deviation of the step errors about their mean as a smooth function of the step, %.

    It comes from second differences, which a smooth mean leaves small; ln σ² is a parabola of the logarithm of the
    step.

    Args:
        log_step: shape (n,).
        error_percent: shape (n,).
    """
    squares = (error_percent[:-2] - 2.0 * error_percent[1:-1] + error_percent[2:]) ** 2 / 6.0
    squares = np.maximum(squares, _LEAST_PERCENT**2)
    place = (log_step - log_step.mean()) / np.ptp(log_step)
    powers = np.column_stack([np.ones(place.size), place, place**2])
    inner = powers[1:-1]
    coefficients = np.linalg.lstsq(inner, np.log(squares) + 1.27, rcond=None)[0]
    # Scoring steps of a gamma model: the weights are equal with a logarithmic link.
    for _ in range(_ROUNDS):
        excess = np.clip(squares * np.exp(-inner @ coefficients) - 1.0, -1.0, 4.0)
        coefficients += np.linalg.lstsq(inner, excess, rcond=None)[0]
    return np.asarray(np.maximum(np.exp(0.5 * powers @ coefficients), _LEAST_PERCENT))


def _models(log_step: Floats, scatter: Floats) -> _Models:
    places = np.arange(scatter.size, dtype=np.float64)
    between, apart = np.abs(places[:, None] - places), np.abs(log_step[:, None] - log_step)
    level = (_LEVEL_PERCENT / scatter[:, None]) * (_LEVEL_PERCENT / scatter)
    smooth = [_matern(apart / length) for length in _LENGTHS]
    shared = [(_shared(between, correlation), weight) for correlation, weight in _CORRELATIONS.items()]
    grid = list(itertools.product(_AMPLITUDES, smooth, shared))
    return _Models(
        np.stack([level + amplitude**2 * kernel for amplitude, kernel, _ in grid]),
        np.stack([noise for _, _, (noise, _) in grid]),
        np.array([weight for _, _, (_, weight) in grid]),
    )


def _matern(apart: Floats) -> Floats:
    far = math.sqrt(5.0) * apart
    return np.asarray((1.0 + far + far**2 / 3.0) * np.exp(-far))


def _shared(between: Floats, correlation: float) -> Floats:
    # Second differences of independent errors have 6 times their variance, of correlated ones 6 − 8ρ + 2ρ².
    grown = 6.0 / (6.0 - 8.0 * correlation + 2.0 * correlation**2)
    sign = np.where(between % 2.0 == 1.0, np.sign(correlation), 1.0)
    return np.asarray(grown * sign * np.abs(correlation) ** between)


def _posterior(models: _Models, values: Floats) -> tuple[Floats, Floats]:
    """Return the probability of each model and its sum of squares, shape (k,) each; the scale is integrated over."""
    roots = np.linalg.cholesky(models.mean + models.noise)
    squares = np.sum(np.linalg.solve(roots, values[:, None])[..., 0] ** 2, axis=1)
    halves = np.log(np.diagonal(roots, axis1=1, axis2=2)).sum(axis=1)
    logs = np.log(models.prior) - halves - 0.5 * (_SCALE_DOF + values.size) * np.log(_SCALE_DOF + squares)
    weights = np.exp(logs - logs.max())
    return np.asarray(weights / weights.sum()), squares


def _draws(
    mean: Floats, noise: Floats, values: Floats, square: float, count: int, rng: np.random.Generator
) -> Floats:
    gain = np.linalg.solve(mean + noise, mean).T
    left = mean - gain @ mean
    variances, directions = np.linalg.eigh(0.5 * (left + left.T))
    root = directions * np.sqrt(np.maximum(variances, 0.0))
    scale = np.sqrt((_SCALE_DOF + square) / rng.chisquare(_SCALE_DOF + values.size, count))
    normal: Floats = rng.standard_normal((count, values.size)) @ root.T
    return np.asarray(gain @ values + scale[:, None] * normal)
