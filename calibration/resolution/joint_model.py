"""Heteroscedastic Gaussian processes of step errors: one for each joint and direction, over log(step) and position.

The mean is the sum of a function of log(step) alone, common to all positions, and one of both: between two positions
that differ, or that are far apart, what is common holds and the uncertainty grows. The noise is learnt from the
spread about the mean: its logarithm is a Gaussian process, too (Goldberg, Williams, Bishop 1997; the most likely
noise as by Kersting et al. 2007). First it follows from differences of neighbouring steps, then from the residuals.
"""

import math
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import linalg, optimize
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.resolution.measured_steps import FEWEST, MeasuredSteps
from catseye.calibration.resolution.tables import ExpectedErrors, JointTable, Sector

BETWEEN = 4
"""Parts into which a table divides the way from one position of tests to the next."""

COMMANDS = 55
"""Steps of a table, from the smallest to the largest measured one in equal ratios."""

_LOG_CHI2 = -1.2703628454614782
"""Mean of the logarithm of χ² with one degree of freedom: −γ − log 2; its variance is π²/2."""

_LEAST_VARIANCE = 1e-6
"""Variance of a step, in %², below which only rounding is left."""

_GROUP = 5
"""Neighbouring steps whose spread is estimated together: the noise changes little among them, and it costs less."""

_ITERATIONS = 25
_SETTLED = 1e-6
"""Relative change of the log likelihood that no longer matters."""

_LEAST_DIFFERENCE = 1.0
"""By how much of their scatter positions differ at least, as a standard deviation: five of them never show that they
are all alike, and the most likely value is often nothing.
"""

_LENGTHS = np.array([[0.3, 3.0], [0.5, 0.5]])
"""Shortest and longest lengths of differences, over log(step) and over position, in their scales.

That over position is half the distance between neighbours, and not learnt: of five positions the most likely length
was now far too long, which takes them for alike, and now far too short. What differs is then unknown half way.
"""


class JointModel:
    """What a step of a joint is expected to do, and how sure that is.

    Args:
        steps: measured ones.

    Raises:
        InsufficientPointsError: there are fewer than `FEWEST`.
    """

    def __init__(self, steps: MeasuredSteps) -> None:
        if steps.commands.size < FEWEST:
            raise InsufficientPointsError(
                f"{steps.name}: {steps.commands.size} steps with an error, {FEWEST} are needed for a model: "
                "measure the whole series"
            )
        order = np.lexsort((steps.commands, steps.positions))
        steps = replace(
            steps,
            positions=steps.positions[order],
            commands=steps.commands[order],
            errors_percent=steps.errors_percent[order],
        )
        self.steps = steps
        log = np.log(steps.commands)
        self._log_centre, self._log_scale = float(log.mean()), float(log.std()) or 1.0
        # The distance between neighbouring positions; 0 of a single one.
        self._spacing = float(np.ptp(steps.positions)) / max(np.unique(steps.positions).size - 1, 1)
        inputs, errors = self._inputs(steps.positions, steps.commands), steps.errors_percent
        same = np.diff(steps.positions) == 0.0
        # Half the squared difference of neighbours: no mean is needed yet.
        between, halves = 0.5 * (inputs[1:] + inputs[:-1]), 0.5 * np.diff(errors) ** 2
        self._noise = _Noise(between[same], halves[same])
        self._mean = self._mean_of(inputs, errors)
        self._noise = _Noise(inputs, self._spread_about_mean(inputs, errors))
        self._mean = self._mean_of(inputs, errors)

    def at(self, positions: Floats, commands: Floats) -> ExpectedErrors:
        """Return the errors expected of steps.

        Args:
            positions: deg or mm, shape (n,).
            commands: sizes, deg or mm, shape (n,).
        """
        inputs = self._inputs(positions, commands)
        scatter = np.sqrt(self._noise.variances(inputs))
        mean, u_mean = self._mean.predict(np.column_stack([inputs, scatter]), return_std=True)
        return ExpectedErrors(mean, scatter, u_mean)

    def _mean_of(self, inputs: Floats, errors: Floats) -> Any:
        """Return the process of the mean, with the noise as it is known."""
        variances = self._noise.variances(inputs)
        with_scatter = np.column_stack([inputs, np.sqrt(variances)])
        return _fitted(_mean_kernel(errors, several=bool(self._spacing)), with_scatter, errors, variances)

    def _spread_about_mean(self, inputs: Floats, errors: Floats) -> Floats:
        """Return squared residuals, each enlarged by what the fit took from it, %², shape (n,).

        The residuals e = Σ C⁻¹ y of a process with covariance C = K + Σ have the variances Σ² diag C⁻¹.
        """
        variances = self._noise.variances(inputs)
        left: Floats = errors - self._mean.predict(np.column_stack([inputs, np.sqrt(variances)]))
        inverse = linalg.cho_solve((self._mean.L_, True), np.eye(len(errors)))
        squares: Floats = left**2 / (variances * np.diag(inverse))
        return squares

    def _inputs(self, positions: Floats, commands: Floats) -> Floats:
        """Return log(step), and the position where there are several, in scales of their own, shape (n, 1 or 2)."""
        logs = (np.log(commands) - self._log_centre) / self._log_scale
        return np.column_stack([logs, positions / self._spacing] if self._spacing else [logs])


def table_of(model: JointModel, reversals: Mapping[float, float]) -> JointTable:
    """Return a model as a look-up table.

    Args:
        reversals: lost motion by position, deg or mm; between two positions it is linear, elsewhere not known.
    """
    steps = model.steps
    tested = np.unique(steps.positions)
    parts = np.linspace(0.0, 1.0, BETWEEN, endpoint=False)
    between = (tested[:-1, None] + parts * np.diff(tested)[:, None]).ravel()
    commands = np.geomspace(steps.commands.min(), steps.commands.max(), COMMANDS)
    return JointTable(
        steps.joint,
        steps.direction,
        tuple(
            Sector(
                float(position),
                commands,
                model.at(np.full(COMMANDS, position), commands),
                _reversal_at(float(position), reversals),
            )
            for position in [*between, tested[-1]]
        ),
    )


def _reversal_at(position: float, reversals: Mapping[float, float]) -> float | None:
    places = sorted(reversals)
    if not places or not places[0] <= position <= places[-1]:
        return None
    return float(np.interp(position, places, [reversals[place] for place in places]))


class _OverStep(RBF):  # type: ignore[misc]  # scikit-learn has no types
    """Of the size of the step alone, whatever the position."""

    def __call__(self, X: Floats, Y: Floats | None = None, eval_gradient: bool = False) -> Any:  # noqa: N803  # scikit-learn's name
        return super().__call__(X[:, :1], None if Y is None else Y[:, :1], eval_gradient)


class _BetweenSectors(RBF):  # type: ignore[misc]  # scikit-learn has no types
    """Of size and position, in parts of the scatter: where steps scatter, positions differ, too."""

    def __call__(self, X: Floats, Y: Floats | None = None, eval_gradient: bool = False) -> Any:  # noqa: N803  # scikit-learn's name
        scale = np.outer(X[:, 2], (X if Y is None else Y)[:, 2])
        found = super().__call__(X[:, :2], None if Y is None else Y[:, :2], eval_gradient)
        return (scale * found[0], scale[..., None] * found[1]) if eval_gradient else scale * found

    def diag(self, X: Floats) -> Floats:  # noqa: N803  # scikit-learn's name
        return np.square(X[:, 2])


class _Noise:
    """The variance of single steps, as the exponential of a Gaussian process.

    Args:
        inputs: where it was estimated, shape (n, 1 or 2).
        variances: estimates from one squared difference each, %², in order of position and step, shape (n,).
    """

    def __init__(self, inputs: Floats, variances: Floats) -> None:
        each = np.log(np.maximum(variances, _LEAST_VARIANCE)) - _LOG_CHI2
        groups = _neighbours(inputs)
        sizes = np.bincount(groups)
        logs = np.bincount(groups, each) / sizes
        inputs = np.column_stack([np.bincount(groups, column) / sizes for column in inputs.T])
        self._centre = float(logs.mean())
        scales = np.array([1.0, 2.0])[: inputs.shape[1]]
        bounds = np.array([[0.3, 20.0], [0.8, 80.0]])[: inputs.shape[1]]
        kernel = ConstantKernel(4.0, (1e-3, 1e3)) * RBF(scales, bounds)
        # The logarithm of a squared normal deviate has this variance, whatever the deviate's own.
        self._process = _fitted(kernel, inputs, logs - self._centre, 0.5 * math.pi**2 / sizes)

    def variances(self, inputs: Floats) -> Floats:
        """Return the variances of steps, %², shape (n,)."""
        found: Floats = np.exp(self._centre + self._process.predict(inputs))
        return np.maximum(found, _LEAST_VARIANCE)


def _neighbours(inputs: Floats) -> Ints:
    """Return numbers of groups of neighbouring steps at one position, shape (n,)."""
    begins = np.flatnonzero(np.diff(inputs[:, -1], prepend=np.nan) != 0.0) if inputs.shape[1] > 1 else [0]
    rank = np.arange(len(inputs)) - np.repeat(begins, np.diff([*begins, len(inputs)]))
    return np.cumsum(rank % _GROUP == 0) - 1


def _mean_kernel(errors: Floats, *, several: bool) -> Kernel:
    """Return the covariance of the mean: what is common to all positions, and what is not."""
    size = max(float(np.var(errors)), 1.0)
    kernel = ConstantKernel(size, (1e-6 * size, 1e3 * size)) * _OverStep(1.0, (0.1, 20.0))
    if several:
        kernel += ConstantKernel(2.0, (_LEAST_DIFFERENCE**2, 1e4)) * _BetweenSectors([1.0, 0.5], _LENGTHS)
    return kernel


def _fitted(kernel: Kernel, inputs: Floats, values: Floats, variances: Floats) -> Any:
    """Return a process whose kernel is the most likely one."""
    process = GaussianProcessRegressor(kernel, alpha=variances, optimizer=_most_likely)
    with warnings.catch_warnings():
        # A length at its bound is what a dependence that is not there looks like.
        warnings.filterwarnings("ignore", "The optimal value found", ConvergenceWarning)
        return process.fit(inputs, values)


def _most_likely(likelihood: Any, start: Floats, bounds: Floats) -> tuple[Floats, float]:
    """Return parameters of a kernel and their negative log likelihood: what scikit-learn calls an optimizer."""
    found, least, _ = optimize.fmin_l_bfgs_b(
        likelihood,
        start,
        bounds=list(map(tuple, bounds)),
        maxiter=_ITERATIONS,
        factr=_SETTLED / np.finfo(float).eps,
    )
    return found, float(least)
