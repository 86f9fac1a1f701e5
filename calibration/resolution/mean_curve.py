"""The mean of the step errors as a function of the step, from one series: a Gaussian process with growing scatter.

Errors of small steps scatter more than those of large ones, and neighbours may be correlated. The mean is the sum of
what is the same share of every step, of what is the same angle at every step, such as an overshoot, and of what is
smooth over the logarithm of the step (Matérn 5/2) and grows with the scatter. How smooth and how large the latter is,
and what neighbours share, are integrated over, not picked. Source: Rasmussen and Williams, Gaussian Processes for
Machine Learning (2006), chapters 2 and 5; the variance of the scatter by a gamma model, as Davidian and Carroll, JASA
82 (1987) 1079.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.linalg import solve_triangular

from catseye.calibration.core.residuals import NORMAL_MAD
from catseye.calibration.core.types import Bools, Floats

_AMPLITUDES: Final = (0.1, 1.0, 10.0, 100.0)
"""Of the smooth part of the mean, over the scatter of a step."""

_LENGTHS: Final = (0.8, 2.4, 7.2)
"""Of the kernel, in e-folds of the step; the paper's window of 11 steps is 0.77 wide."""

_CORRELATIONS: Final = {-0.25: 0.044, 0.0: 1.0, 0.25: 0.044}
"""Of neighbours, each with its prior weight: normal with a standard deviation of 0.1.

A step starts from where the joint was measured to stand, so what the last one missed by is not in it: correlation is
possible, but hardly any is expected.
"""

_NONE: Final = {0.0: 1.0}

_LEVEL_PERCENT: Final = 10.0
"""Prior standard deviation of what all steps share."""

_OFFSET: Final = 100.0
"""Prior standard deviation of an error of the same size at every step, over the scatter, rms: hardly any prior."""

_SCALE_DOF: Final = 4.0
"""Of the prior of the scatter's scale: weak beside some hundred steps."""

_ROUNDS: Final = 8
_LEAST_PERCENT: Final = 1e-3
"""Scatter below this is rounding."""


@dataclass(frozen=True)
class _Model:
    """A point of the grid; covariances are over that of the scatter's scale, in units of the scatter.

    Attributes:
        mean: covariance of the mean curve, shape (n, n).
        across: that of the step errors that count with the mean curve, shape (k, n).
        root: Cholesky factor of that of the step errors that count, shape (k, k).
        whitened: step errors that count over the root, shape (k,).
        log_weight: logarithm of its probability, but for a constant.
    """

    mean: Floats
    across: Floats
    root: Floats
    whitened: Floats
    log_weight: float


def draw_mean_curves(
    log_step: Floats, error_percent: Floats, counted: Bools, draws: int, rng: np.random.Generator
) -> Floats:
    """Return mean curves of the step error that agree with one series, as often as they are likely.

    Args:
        log_step: natural logarithm of the commanded steps, decreasing, shape (n,).
        error_percent: E_s of each, %, shape (n,).
        counted: which of them the curves have to agree with, shape (n,).

    Returns:
        Means at the steps, %, shape (draws, n).
    """
    scatter = scatter_percent(log_step, error_percent, counted)
    models = _models(log_step, scatter, error_percent / scatter, counted, _CORRELATIONS)
    weights = np.exp([model.log_weight for model in models])
    counts = rng.multinomial(draws, weights / weights.sum())
    curves = [_draws(models[k], int(counts[k]), rng) for k in np.flatnonzero(counts)]
    return np.asarray(np.concatenate(curves) * scatter)


def off_the_others(log_step: Floats, error_percent: Floats, counted: Bools) -> tuple[Floats, Floats]:
    """Return how far each step lies off what all others that count say of it.

    The likeliest model says so, of those in which neighbours are independent.

    Args:
        log_step: as `draw_mean_curves` takes it, like the following two.

    Returns:
        The distance, %, and the same over its standard deviation, shape (n,) each.
    """
    scatter = scatter_percent(log_step, error_percent, counted)
    values = error_percent / scatter
    model = max(_models(log_step, scatter, values, counted, _NONE), key=lambda one: one.log_weight)
    gain = solve_triangular(model.root, model.across, lower=True, check_finite=False)
    off = values - gain.T @ model.whitened
    deviation = np.sqrt(1.0 + np.maximum(np.diagonal(model.mean) - np.sum(gain**2, axis=0), 0.0))
    # What a step that counts is off the others follows from the inverse (Rasmussen and Williams, equation 5.12).
    half = solve_triangular(model.root, np.eye(model.whitened.size), lower=True, check_finite=False)
    precision = np.sum(half**2, axis=0)
    off[counted], deviation[counted] = half.T @ model.whitened / precision, precision**-0.5
    scale = max(1.0, float(np.median(np.abs(off / deviation)[counted])) / NORMAL_MAD)
    return off * scatter, off / (deviation * scale)


def scatter_percent(log_step: Floats, error_percent: Floats, counted: Bools) -> Floats:
    """Return the standard deviation of the step errors about their mean as a smooth function of the step, %.

    It comes from second differences, which a smooth mean leaves small; ln σ² is a parabola of the logarithm of the
    step.

    Args:
        log_step: shape (n,).
        error_percent: shape (n,).
        counted: which of them say something about it, shape (n,).
    """
    squares = np.diff(error_percent[counted], 2) ** 2 / 6.0
    squares = np.maximum(squares, _LEAST_PERCENT**2)
    place = (log_step - log_step.mean()) / np.ptp(log_step)
    powers = np.column_stack([np.ones(place.size), place, place**2])
    inner = powers[counted][1:-1]
    coefficients = np.linalg.lstsq(inner, np.log(squares) + 1.27, rcond=None)[0]
    # Scoring steps of a gamma model: the weights are equal with a logarithmic link.
    for _ in range(_ROUNDS):
        excess = np.clip(squares * np.exp(-inner @ coefficients) - 1.0, -1.0, 4.0)
        coefficients += np.linalg.lstsq(inner, excess, rcond=None)[0]
    return np.asarray(np.maximum(np.exp(0.5 * powers @ coefficients), _LEAST_PERCENT))


def _models(
    log_step: Floats, scatter: Floats, values: Floats, counted: Bools, correlations: Mapping[float, float]
) -> list[_Model]:
    places = np.arange(scatter.size, dtype=np.float64)
    between, apart = np.abs(places[:, None] - places), np.abs(log_step[:, None] - log_step)
    level = _LEVEL_PERCENT / scatter
    offset = np.exp(log_step.mean() - log_step) / scatter
    offset *= _OFFSET / np.sqrt(np.mean(offset**2))
    large = np.outer(level, level) + np.outer(offset, offset)
    smooth = [
        large + amplitude**2 * _matern(apart / length) for amplitude in _AMPLITUDES for length in _LENGTHS
    ]
    shared = [(_shared(between, correlation), weight) for correlation, weight in correlations.items()]
    models = [_model(mean, noise, weight, values, counted) for mean in smooth for noise, weight in shared]
    most = max(model.log_weight for model in models)
    return [replace(model, log_weight=model.log_weight - most) for model in models]


def _model(mean: Floats, noise: Floats, prior: float, values: Floats, counted: Bools) -> _Model:
    """Return a model with its probability; the scale of the scatter is integrated over."""
    root = np.asarray(np.linalg.cholesky((mean + noise)[np.ix_(counted, counted)]), dtype=np.float64)
    whitened = solve_triangular(root, values[counted], lower=True, check_finite=False)
    likely = -0.5 * (_SCALE_DOF + whitened.size) * math.log(_SCALE_DOF + whitened @ whitened)
    log_weight = math.log(prior) - float(np.log(np.diagonal(root)).sum()) + likely
    return _Model(mean, mean[counted], root, whitened, log_weight)


def _matern(apart: Floats) -> Floats:
    far = math.sqrt(5.0) * apart
    return np.asarray((1.0 + far + far**2 / 3.0) * np.exp(-far))


def _shared(between: Floats, correlation: float) -> Floats:
    # Second differences of independent errors have 6 times their variance, of correlated ones 6 − 8ρ + 2ρ².
    grown = 6.0 / (6.0 - 8.0 * correlation + 2.0 * correlation**2)
    sign = np.where(between % 2.0 == 1.0, np.sign(correlation), 1.0)
    return np.asarray(grown * sign * np.abs(correlation) ** between)


def _draws(model: _Model, count: int, rng: np.random.Generator) -> Floats:
    """Return mean curves of one model, shape (count, n): draws of the prior, conditioned on the series."""
    gain = solve_triangular(model.root, model.across, lower=True, check_finite=False)
    left = model.mean - gain.T @ gain
    variances, directions = np.linalg.eigh(0.5 * (left + left.T))
    root = directions * np.sqrt(np.maximum(variances, 0.0))
    dof = _SCALE_DOF + model.whitened.size
    scale = np.sqrt((_SCALE_DOF + model.whitened @ model.whitened) / rng.chisquare(dof, count))
    normal: Floats = rng.standard_normal((count, variances.size)) @ root.T
    return np.asarray(gain.T @ model.whitened + scale[:, None] * normal)
