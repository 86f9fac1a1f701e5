"""Gauss-Newton steps over sums: each evaluation is a pass over all rows, so none is wasted."""

from collections.abc import Callable
from dataclasses import dataclass

from catseye.calibration.core.blockwise.normal_sums import NormalSums
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.gauge import Gauge
from catseye.calibration.core.least_squares import MAX_ITERATIONS, ROUNDING, STEP_TOLERANCE, NormalEquations
from catseye.calibration.core.types import Floats

_LARGEST_DAMPING = 1e-6
"""A step that is damped more than this may be short although the minimum is far."""


@dataclass(frozen=True)
class Minimum:
    """Where the steps ended.

    Attributes:
        parameters: estimate, shape (p,).
        sums: of the last pass, one step of less than the tolerance away.
        passes: over the rows.
    """

    parameters: Floats
    sums: NormalSums
    passes: int


def descend(sums_at: Callable[[Floats], NormalSums], start: Floats, gauge: Gauge, unsettled: str) -> Minimum:
    """Minimise a sum of squares whose normal equations come from passes.

    The normal equations say beforehand how much a step changes the residuals; the last one, below the tolerance of
    the solver, is taken without another pass.

    Args:
        sums_at: sums over all rows at parameters of shape (p,).
        start: starting values, shape (p,); they fulfil the gauge.
        gauge: that the steps keep.
        unsettled: advice for an iteration that does not settle.

    Raises:
        ConvergenceError: no convergence within the iteration limit.
    """
    parameters, sums, damping = start, sums_at(start), 0.0
    equations = NormalEquations.of(gauge.reduced(sums.matrix()), sums.gradient, gauge.basis)
    for passes in range(1, MAX_ITERATIONS + 1):
        step, damping = _definite_step(equations, damping)
        change_mm = sums.change_mm(step)
        if change_mm < STEP_TOLERANCE and damping <= _LARGEST_DAMPING:
            return Minimum(parameters + step, sums, passes)
        trial = sums_at(parameters + step)
        # The cost is what shared errors leave of the white one, and has the rounding of that.
        if trial.cost <= sums.cost + ROUNDING * sums.white_cost:
            parameters, sums, damping = parameters + step, trial, 0.0
            equations = NormalEquations.of(gauge.reduced(sums.matrix()), sums.gradient, gauge.basis)
        else:
            damping = max(10.0 * damping, 1e-9)
    raise ConvergenceError(
        f"no convergence after {MAX_ITERATIONS} passes over the rows (last change {change_mm:.3g} mm rms): "
        f"{unsettled}"
    )


def improved(start: Floats, sums: NormalSums, gauge: Gauge) -> Floats:
    """Return where one step leads; from nearby it leads nearly to the minimum.

    Args:
        start: where the sums were taken, shape (p,).

    Raises:
        ConvergenceError: the sums hold no usable numbers.
    """
    equations = NormalEquations.of(gauge.reduced(sums.matrix()), sums.gradient, gauge.basis)
    return start + _definite_step(equations, 0.0)[0]


def _definite_step(equations: NormalEquations, damping: float) -> tuple[Floats, float]:
    """Return a step with the least damping, from the given one on, that makes the matrix positive definite."""
    for _ in range(30):
        step = equations.step(damping)
        if step is not None:
            return step, damping
        damping = max(10.0 * damping, 1e-12)
    raise ConvergenceError(
        "the normal equations hold no usable numbers; look for rows that are not finite or mixed up"
    )
