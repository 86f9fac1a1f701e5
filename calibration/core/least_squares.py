"""Whitened non-linear least squares: Gauss-Newton steps, damped after Levenberg and Marquardt when they fail.

Steps come from the normal equations in scaled columns, which the iteration corrects; rank and covariance come
from QR and singular values of the Jacobian itself, where squaring would hide a null direction.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.core.whitening import Whitening

RANK_TOLERANCE = 1e-10
"""Singular values of the scaled Jacobian below this share of the largest count as zero."""

STEP_TOLERANCE = 1e-8
"""The iteration ends after a step that changes the residuals by less than this (rms, residual units)."""

MAX_ITERATIONS = 50

ROUNDING = 1e-12
"""Share by which rounding may change a sum of squares."""

_SHORT_MM = 1e-6
"""A step that changes residuals by less, rms, leaves the derivatives: they are good to a hundred-millionth."""

_FAST = 0.01
"""Steps that shrink to less than this from one to the next leave the normal matrix; the gradient must be exact."""


@dataclass(frozen=True)
class Factor:
    """Singular values of a scaled, whitened Jacobian on a basis of free steps.

    Attributes:
        singular_values: of the scaled columns, descending, shape (free,).
        right: right singular vectors as rows, shape (free, free).
        scale: column norms that the columns were divided by, shape (free,).
    """

    singular_values: Floats
    right: Floats
    scale: Floats

    @property
    def regular(self) -> Bools:
        """Flags of the directions that the rows determine, shape (free,)."""
        return np.asarray(self.singular_values > RANK_TOLERANCE * self.singular_values[0])

    def covariance(self) -> Floats:
        """Return the covariance of the free directions for unit weights, shape (free, free)."""
        regular = self.regular
        inverse = np.where(regular, 1.0 / np.where(regular, self.singular_values, 1.0), 0.0)
        half = (self.right.T * inverse) / self.scale[:, None]
        return np.asarray(half @ half.T, dtype=np.float64)

    def covariance_on(self, basis: Floats) -> Floats:
        """Return the covariance of the parameters for unit weights, shape (p, p).

        Args:
            basis: steps that keep the gauge, shape (p, free).
        """
        return np.asarray(basis @ self.covariance() @ basis.T, dtype=np.float64)


def factorise(jacobian: Floats) -> Factor:
    """Decompose a whitened Jacobian of shape (n, free)."""
    scale = _column_norms(jacobian)
    triangle = linalg.qr(jacobian / scale, mode="r", overwrite_a=True, check_finite=False)[0]
    _, values, right = linalg.svd(triangle[: jacobian.shape[1]], check_finite=False)
    padded = np.zeros(jacobian.shape[1])
    padded[: values.size] = values
    return Factor(padded, right, scale)


def column_space(columns: Floats) -> Floats:
    """Return an orthonormal basis of what columns of shape (n, k) span, shape (n, rank); the columns are overwritten.

    Columns that rows leave undetermined, such as those of a segment without rows, are none of its directions.
    """
    columns /= _column_norms(columns)
    basis, triangle = linalg.qr(columns, mode="economic", overwrite_a=True, check_finite=False)
    left, values, _ = linalg.svd(triangle, check_finite=False)
    known = values > RANK_TOLERANCE * values[0]
    return np.asarray(basis if known.all() else basis @ left[:, : values.size][:, known], dtype=np.float64)


@dataclass(frozen=True)
class Solution:
    """Where the iteration ended.

    Attributes:
        parameters: estimate, shape (p,).
        residuals: residuals there, mm, shape (n,).
        iterations: steps taken.
        derivatives: of the residuals at parameters of shape (p,), shape (n, p).
        whitening: of the residuals.
        basis: steps that keep the gauge, shape (p, free).
    """

    parameters: Floats
    residuals: Floats
    iterations: int
    derivatives: Callable[[Floats], Floats]
    whitening: Whitening
    basis: Floats

    @cached_property
    def jacobian(self) -> Floats:
        """Derivatives there, shape (n, p)."""
        return self.derivatives(self.parameters)

    @cached_property
    def free(self) -> Floats:
        """Whitened Jacobian there on the free directions, shape (n, free)."""
        return np.asarray(self.whitening.rows(self.jacobian) @ self.basis, dtype=np.float64)

    @cached_property
    def factor(self) -> Factor:
        """Decomposition of the whitened Jacobian on the free directions; it takes as long as two steps."""
        return factorise(self.free)


def minimise(
    residuals: Callable[[Floats], Floats],
    jacobian: Callable[[Floats], Floats],
    start: Floats,
    basis: Floats,
    whitening: Whitening,
    unsettled: str = "check the starting values",
    near: Floats | None = None,
    tolerance_mm: float = STEP_TOLERANCE,
) -> Solution:
    """Minimise the sum of squares of the whitened residuals.

    Args:
        residuals: residuals at parameters of shape (p,), mm, shape (n,).
        jacobian: their derivatives, shape (n, p).
        start: starting values, shape (p,); they fulfil the gauge.
        basis: steps that keep the gauge, shape (p, free).
        whitening: of the residuals.
        unsettled: advice for an iteration that does not settle.
        near: derivatives at a minimum of nearly the same rows, to begin with, shape (n, p).
        tolerance_mm: end after a step that changes the residuals by less, rms.

    Raises:
        ConvergenceError: no convergence within the iteration limit, or no step lowers the residuals.
    """
    parameters, current = start, residuals(start)
    slopes = jacobian(start) if near is None else near
    matrix = basis.T @ whitening.products(slopes) @ basis
    before = 0.0 if near is None else math.inf
    for iteration in range(1, MAX_ITERATIONS + 1):
        equations = NormalEquations.of(matrix, slopes.T @ whitening.forces(current), basis)
        parameters, current, change = _improve(residuals, parameters, current, whitening, equations)
        if change < tolerance_mm:
            return Solution(parameters, current, iteration, jacobian, whitening, basis)
        if change > _SHORT_MM:
            slopes = jacobian(parameters)
        if change > _FAST * before:
            matrix = basis.T @ whitening.products(slopes) @ basis
        before = change
    raise ConvergenceError(
        f"no convergence after {MAX_ITERATIONS} iterations (last change {change:.3g} mm rms): {unsettled}"
    )


@dataclass(frozen=True)
class NormalEquations:
    """Normal equations in scaled free directions.

    Attributes:
        matrix: scaled, its diagonal is 1, shape (free, free).
        gradient: scaled, shape (free,).
        directions: the free directions divided by their scale, shape (p, free).
    """

    matrix: Floats
    gradient: Floats
    directions: Floats

    @classmethod
    def of(cls, reduced: Floats, gradient: Floats, basis: Floats) -> "NormalEquations":
        """Scale BᵀJᵀWJB, shape (free, free), and JᵀWr, shape (p,), for a basis B of shape (p, free)."""
        diagonal = np.diag(reduced)
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        directions = basis * scale
        return cls(reduced * np.outer(scale, scale), directions.T @ gradient, directions)

    def step(self, damping: float) -> Floats | None:
        """Return the damped step in all parameters, or None when the matrix is not positive definite."""
        damped = self.matrix + damping * np.eye(self.matrix.shape[0])
        try:
            factor = linalg.cho_factor(damped, overwrite_a=True, check_finite=False)
        except linalg.LinAlgError:
            return None
        solution = linalg.cho_solve(factor, self.gradient, check_finite=False)
        return np.asarray(-(self.directions @ solution), dtype=np.float64)


def _improve(
    residuals: Callable[[Floats], Floats],
    parameters: Floats,
    current: Floats,
    whitening: Whitening,
    equations: NormalEquations,
) -> tuple[Floats, Floats, float]:
    """Return better parameters, their residuals and the rms change of the residuals."""
    cost = whitening.square(current)
    damping = 0.0
    for _ in range(30):
        step = equations.step(damping)
        if step is not None:
            trial = residuals(parameters + step)
            change = float(np.sqrt(np.mean((trial - current) ** 2)))
            # At the minimum rounding decides whether the cost still falls; the gradient is better than that.
            rounding = 0.0 if damping else ROUNDING * cost
            if whitening.square(trial) < cost + rounding or (change < STEP_TOLERANCE and damping == 0.0):
                return parameters + step, trial, change
            if change < STEP_TOLERANCE:
                return parameters, current, change
        damping = max(10.0 * damping, 1e-9)
    raise ConvergenceError(
        "the residuals do not fall in any direction; look for rows that are not finite or mixed up"
    )


def _column_norms(matrix: Floats) -> Floats:
    norms = np.sqrt(np.einsum("ij,ij->j", matrix, matrix))
    return np.where(norms > 0.0, norms, 1.0)
