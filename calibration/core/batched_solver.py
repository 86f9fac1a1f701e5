"""Many measurements of one and the same plan, solved at once.

The draws of a Monte Carlo differ in their measured values only. Each is solved to the minimum of its own non-linear
sum of squares: the gradient is exact at every iterate; the Hessian begins as that of the nominal solution and learns
from the steps (limited-memory BFGS).
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from catseye.calibration.core.gain import gain
from catseye.calibration.core.least_squares import factorise, minimise
from catseye.calibration.core.model import Model
from catseye.calibration.core.types import Bools, Floats

_STEP_TOLERANCE_MM = 1e-9
"""A draw is solved after a step that changes its residuals by less than this, rms."""

_MOST_STEPS = 25
"""A draw that is not solved by then is left to the damped solver."""

_BATCH_NUMBERS = 14_000
"""Rows solved at once: their arrays (100 kB each) stay in the cache."""


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

    def gradient(self, values: Floats, measured_mm: Floats) -> Floats:
        """Return half the gradients of the weighted sums of squares, JᵀW²r.

        Args:
            values: of the parameters, one column a draw, shape (p, b).
            measured_mm: one column a draw, shape (n, b).

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
        weights: reciprocal standard uncertainties, shape (n,).
        gain: what the estimate moves by per row, to first order, shape (p, n).
        directions: steps within the gauge that each change the weighted residuals by 1, shape (p, free).
    """

    rows: BatchedRows
    nominal: Floats
    predicted_mm: Floats
    weights: Floats
    gain: Floats
    directions: Floats

    @classmethod
    def of(cls, rows: BatchedRows, nominal: Floats) -> "BatchedProblem":
        """Prepare a plan.

        Args:
            rows: their measured values are not used.
            nominal: solution that the draws scatter about, shape (p,); the rows determine it.
        """
        model = rows.model
        weights, basis = model.weights, model.parameters.basis
        jacobian = model.jacobian(nominal) * weights[:, None]
        factor = factorise(jacobian @ basis)
        root = basis @ (factor.right.T / factor.singular_values / factor.scale[:, None])
        return cls(
            rows=rows,
            nominal=nominal,
            predicted_mm=model.residuals(nominal) + rows.measured_mm,
            weights=weights,
            gain=gain(model, nominal),
            directions=root,
        )


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

    Draws that do not settle, or that a step throws further than their errors reach, are solved by damped Gauss-Newton
    steps.

    Args:
        problem: what the draws have in common.
        noise_mm: errors of the rows, one row a draw, shape (draws, n).

    Raises:
        ConvergenceError: a draw has no minimum near the nominal values.
    """
    found = np.empty((noise_mm.shape[0], problem.nominal.size))
    open_ = np.zeros(noise_mm.shape[0], dtype=np.bool_)
    batch = max(1, _BATCH_NUMBERS // noise_mm.shape[1])
    for first in range(0, noise_mm.shape[0], batch):
        part = slice(first, first + batch)
        found[part], open_[part] = _solve_batch(problem, np.ascontiguousarray(noise_mm[part].T))
    for k in np.flatnonzero(open_):
        found[k] = _solve_alone(problem, noise_mm[k])
    return Solved(found, int(open_.sum()))


def _solve_batch(problem: BatchedProblem, noise_mm: Floats) -> tuple[Floats, Bools]:
    """Return solutions (b, p) of errors (n, b), and which of them were not reached."""
    measured = problem.predicted_mm[:, None] + noise_mm
    parameters = problem.nominal[:, None] + problem.gain @ noise_mm
    settled = _STEP_TOLERANCE_MM * np.sqrt(measured.shape[0]) * problem.weights.min()
    farthest = _lengths(noise_mm * problem.weights[:, None])
    open_, memory = np.arange(measured.shape[1]), _Memory([], [])
    flags = np.ones(measured.shape[1], dtype=np.bool_)
    for _ in range(_MOST_STEPS):
        gradient = problem.rows.gradient(parameters[:, open_], measured[:, open_])
        step = memory.step(problem.directions.T @ gradient)
        parameters[:, open_] += problem.directions @ step
        size = _lengths(step)
        flags[open_[size < settled]] = False
        going = (size >= settled) & (size <= farthest[open_])
        if not going.any():
            break
        open_, memory = open_[going], memory.select(going)
    return parameters.T, flags


@dataclass
class _Memory:
    """What steps and gradients say about the inverse Hessians of draws; without any it is 1.

    Attributes:
        steps: earlier steps, shape (free, b) each.
        changes: of the gradient by each step; the last entry is the gradient itself until the next is known.
    """

    steps: list[Floats]
    changes: list[Floats]

    def step(self, gradient: Floats) -> Floats:
        """Return the next step, shape (free, b), at a gradient of this shape (two-loop recursion)."""
        if self.changes:
            self.changes[-1] = gradient - self.changes[-1]
        step = -gradient
        scales = [_reciprocal(_dots(s, y)) for s, y in zip(self.steps, self.changes, strict=True)]
        known = list(zip(self.steps, self.changes, scales, strict=True))
        shares = []
        for s, y, scale in reversed(known):
            shares.append(scale * _dots(s, step))
            step = step - shares[-1] * y
        for (s, y, scale), share in zip(known, reversed(shares), strict=True):
            step = step + s * (share - scale * _dots(y, step))
        self.steps.append(step)
        self.changes.append(gradient)
        return step

    def select(self, draws: Bools) -> "_Memory":
        """Return what is known of the chosen draws."""
        if draws.all():
            return self
        return _Memory([one[:, draws] for one in self.steps], [one[:, draws] for one in self.changes])


def _dots(first: Floats, second: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->j", first, second), dtype=np.float64)


def _lengths(columns: Floats) -> Floats:
    return np.sqrt(_dots(columns, columns))


def _reciprocal(curvature: Floats) -> Floats:
    """Return 1/curvature, 0 where it is not positive: such a step teaches nothing."""
    usable = curvature > 0.0
    return np.where(usable, 1.0 / np.where(usable, curvature, 1.0), 0.0)


def _solve_alone(problem: BatchedProblem, noise_mm: Floats) -> Floats:
    model = problem.rows.with_measured(problem.predicted_mm + noise_mm)
    basis = model.parameters.basis
    return minimise(model.residuals, model.jacobian, problem.nominal, basis, problem.weights).parameters
