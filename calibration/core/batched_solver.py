"""Many measurements of one and the same plan, solved at once.

The draws of a Monte Carlo differ in their measured values only. Each is solved to the minimum of its own non-linear
sum of squares: the gradient is exact at every iterate; the curvature begins as that of the nominal solution and
learns from the steps (limited-memory BFGS). A well-determined draw takes one step beyond the linear estimate.

Simpler iterations were measured. With the nominal gain on the residuals alone the steps end where the residuals are
orthogonal to the nominal Jacobian: up to 5e-4 standard uncertainties off the minimum on the paper's layout, 4e-3 with
terms that the maps nearly absorb. With exact gradients and a curvature that learns nothing the latter do not settle.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from catseye.calibration.core.gain import Gain
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Bools, Floats

_SETTLED = 1e-6
"""A draw is solved when what is left is expected to be less than this share of its first step."""

_ROUNDING = 1e-9
"""A step that is shorter, in standard uncertainties, is rounding."""

_FARTHEST = 10.0
"""A draw is given up when a step is so many times as long as its first one."""

_MOST_STEPS = 25
"""A draw that is not solved by then is left to the damped solver."""


class BatchedRows(Protocol):
    """Rows of many draws at once; n rows, p parameters, b draws."""

    @property
    def model(self) -> Model:
        """The rows of a single draw."""
        ...

    @property
    def measured_mm(self) -> Floats:
        """What was measured, mm, shape (n,)."""
        ...

    def with_measured(self, measured_mm: Floats) -> Model:
        """Return the rows of a draw, measured values of shape (n,)."""
        ...

    def gradient(self, values: Floats, measured_mm: Floats, forces: Callable[[Floats], Floats]) -> Floats:
        """Return half the gradients of the sums of squares, JᵀV⁻¹r.

        Args:
            values: of the parameters, one column a draw, shape (p, b).
            measured_mm: one column a draw, shape (n, b).
            forces: returns V⁻¹ times residuals, shape (n, b).

        Returns:
            Gradients, shape (p, b).
        """
        ...


@dataclass(frozen=True)
class BatchedProblem:
    """What all draws have in common.

    Attributes:
        rows: residuals and their gradients.
        nominal: parameters that the draws scatter about, shape (p,).
        predicted_mm: measured values that the model predicts there, shape (n,).
        gain: of the estimator there.
    """

    rows: BatchedRows
    nominal: Floats
    predicted_mm: Floats
    gain: Gain

    @classmethod
    def of(cls, rows: BatchedRows, nominal: Floats) -> "BatchedProblem":
        """Prepare a plan.

        Args:
            rows: their measured values are not used.
            nominal: solution that the draws scatter about, shape (p,); the rows determine it.
        """
        predicted_mm = rows.model.residuals(nominal) + rows.measured_mm
        return cls(rows, nominal, predicted_mm, Gain.at(rows.model, nominal))


@dataclass(frozen=True)
class Solved:
    """Solutions of draws.

    Attributes:
        parameters: one row a draw, shape (draws, p).
        fallbacks: draws that the damped solver had to solve.
    """

    parameters: Floats
    fallbacks: int


def solve_draws(problem: BatchedProblem, noise_mm: Floats) -> Solved:
    """Estimate from the predicted values with errors added, every draw to the minimum of its own sum of squares.

    Draws that do not settle, or that a step throws far off, are solved by damped Gauss-Newton steps.

    Args:
        problem: what the draws have in common.
        noise_mm: errors of the rows, one row a draw, shape (draws, n).

    Raises:
        ConvergenceError: a draw has no minimum near the nominal values.
    """
    found, open_ = _solve_batch(problem, np.ascontiguousarray(noise_mm.T))
    for k in np.flatnonzero(open_):
        found[k] = _solve_alone(problem, noise_mm[k])
    return Solved(found, int(open_.sum()))


def _solve_batch(problem: BatchedProblem, noise_mm: Floats) -> tuple[Floats, Bools]:
    """Return solutions (b, p) of errors (n, b), and which of them were not reached."""
    gain, measured = problem.gain, problem.predicted_mm[:, None] + noise_mm
    u = np.sqrt(np.diag(gain.covariance))[:, None]
    step = gain.matrix @ noise_mm
    first = size = np.abs(step / u).max(axis=0)
    slowest = 0.0
    parameters = problem.nominal[:, None] + step
    open_, memory = np.arange(measured.shape[1]), _Memory(gain.covariance, [], [])
    flags = np.ones(measured.shape[1], dtype=np.bool_)
    for _ in range(_MOST_STEPS):
        step = memory.step(problem.rows.gradient(parameters[:, open_], measured[:, open_], gain.forces))
        parameters[:, open_] += step
        before, size = size, np.abs(step / u).max(axis=0)
        # How fast steps shrink is a matter of the plan: what is left counts as the slowest draw of all shows it.
        slowest = max(slowest, float((size / np.maximum(before, _ROUNDING)).max()))
        settled = (size * slowest <= _SETTLED * first[open_]) | (size < _ROUNDING)
        flags[open_[settled]] = False
        going = ~settled & (size <= _FARTHEST * first[open_])
        if not going.any():
            break
        open_, memory, size = open_[going], memory.select(going), size[going]
    return parameters.T, flags


@dataclass
class _Memory:
    """What steps and gradients say about the inverse curvatures of draws.

    Attributes:
        inverse: inverse curvature of the nominal solution, shape (p, p).
        steps: earlier steps, shape (p, b) each.
        changes: of the gradient by each step; the last entry is the gradient itself until the next is known.
    """

    inverse: Floats
    steps: list[Floats]
    changes: list[Floats]

    def step(self, gradient: Floats) -> Floats:
        """Return the next step, shape (p, b), at a gradient of this shape (two-loop recursion)."""
        if self.changes:
            self.changes[-1] = gradient - self.changes[-1]
        scales = [_reciprocal(_dots(s, y)) for s, y in zip(self.steps, self.changes, strict=True)]
        known = list(zip(self.steps, self.changes, scales, strict=True))
        left, shares = gradient, []
        for s, y, scale in reversed(known):
            shares.append(scale * _dots(s, left))
            left = left - shares[-1] * y
        step = -(self.inverse @ left)
        for (s, y, scale), share in zip(known, reversed(shares), strict=True):
            step = step - s * (share + scale * _dots(y, step))
        self.steps.append(step)
        self.changes.append(gradient)
        return step

    def select(self, draws: Bools) -> "_Memory":
        """Return what is known of the chosen draws."""
        chosen = [[one[:, draws] for one in known] for known in (self.steps, self.changes)]
        return _Memory(self.inverse, *chosen)


def _dots(first: Floats, second: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->j", first, second), dtype=np.float64)


def _reciprocal(curvature: Floats) -> Floats:
    """Return 1/curvature, 0 where it is not positive: such a step teaches nothing."""
    usable = curvature > 0.0
    return np.where(usable, 1.0 / np.where(usable, curvature, 1.0), 0.0)


def _solve_alone(problem: BatchedProblem, noise_mm: Floats) -> Floats:
    model = problem.rows.with_measured(problem.predicted_mm + noise_mm)
    basis, whitening = model.parameters.basis, problem.gain.whitening
    return minimise(model.residuals, model.jacobian, problem.nominal, basis, whitening).parameters
