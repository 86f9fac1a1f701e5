"""Many measurements of one and the same plan, identified at once.

The draws of a Monte Carlo differ in their distances only. Each is solved to the minimum of its own non-linear sum of
squares: the gradient is exact at every iterate; the Hessian begins as that of the nominal solution and learns from
the steps (limited-memory BFGS). The gradient needs no dense Jacobian: commands that repeat share their trigonometry,
and what is linear is sparse.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from catseye.calibration.core.fit_statistics import point_weights
from catseye.calibration.core.least_squares import factorise, minimise
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.distance_model import DistanceModel

_STEP_TOLERANCE_MM = 1e-9
"""A draw is solved after a step that changes its residuals by less than this, rms."""

_MOST_STEPS = 25
"""A draw that is not solved by then is left to the damped solver."""

_BATCH_NUMBERS = 14_000
"""Distances solved at once: their arrays (100 kB each) stay in the cache."""


@dataclass(frozen=True)
class BatchedProblem:
    """What all draws have in common; m distinct arm states among n distances, p parameters.

    Attributes:
        model: the distances, their commands and the order of the parameters.
        nominal: parameters that the draws scatter about, shape (p,).
        predicted_mm: displacements that the model predicts there, shape (n,).
        weights: reciprocal standard uncertainties, shape (n,).
        squares: their squares, shape (n, 1).
        gain: what the estimate moves by per distance, to first order, shape (p, n).
        directions: steps within the gauge that each change the weighted residuals by 1, shape (p, free).
        command_rad: θ1 and θ2 commands of the states, shape (2, m, 1).
        to_states: parameters to L1, L2, θ1 and θ2 of the states, shape (4 m, p).
        from_states: its transpose.
        to_rows: parameters to minus reflector x, y and to what is added to the lengths, shape (3 n, p).
        from_rows: its transpose.
        state: state of each distance, shape (n,).
        gather: sums distances over their state, shape (m, n).
    """

    model: DistanceModel
    nominal: Floats
    predicted_mm: Floats
    weights: Floats
    squares: Floats
    gain: Floats
    directions: Floats
    command_rad: Floats
    to_states: sparse.csr_array
    from_states: sparse.csr_array
    to_rows: sparse.csr_array
    from_rows: sparse.csr_array
    state: Ints
    gather: sparse.csr_array

    @classmethod
    def of(cls, model: DistanceModel, nominal: Floats) -> "BatchedProblem":
        """Prepare a plan.

        Args:
            model: the distances; their displacements are not used.
            nominal: solution that the draws scatter about, shape (p,); the distances determine it.
        """
        weights, basis = point_weights(model.points), model.layout.gauge_basis()
        jacobian = model.jacobian(nominal) * weights[:, None]
        factor = factorise(jacobian @ basis)
        root = basis @ (factor.right.T / factor.singular_values / factor.scale[:, None])
        first, state = _distinct_states(model)
        to_states, to_rows = _arm_matrix(model, first), _row_matrix(model)
        rows = np.arange(state.size)
        return cls(
            model=model,
            nominal=nominal,
            predicted_mm=model.residuals(nominal) + model.points.displacement_mm,
            weights=weights,
            squares=(weights**2)[:, None],
            gain=root @ (root.T @ (jacobian * weights[:, None]).T),
            directions=root,
            command_rad=np.stack([model.design.commands.theta1_rad, model.design.commands.theta2_rad])[
                :, first, None
            ],
            to_states=to_states,
            from_states=to_states.T.tocsr(),
            to_rows=to_rows,
            from_rows=to_rows.T.tocsr(),
            state=state,
            gather=sparse.csr_array((np.ones(rows.size), (state, rows)), shape=(first.size, rows.size)),
        )

    def gradient(self, parameters: Floats, displacement_mm: Floats) -> Floats:
        """Return half the gradient of the weighted sums of squared residuals.

        Args:
            parameters: one column a draw, shape (p, b).
            displacement_mm: their distances, shape (n, b).

        Returns:
            The exact Jᵀ W² r, shape (p, b).
        """
        draws = parameters.shape[1]
        link1, link2, theta1, theta2 = (self.to_states @ parameters).reshape(4, -1, draws)
        theta1 += self.command_rad[0]
        both = theta1 + theta2
        both += self.command_rad[1]
        cos1, sin1, cos12, sin12 = np.cos(theta1), np.sin(theta1), np.cos(both), np.sin(both)
        x2, y2 = link2 * cos12, link2 * sin12
        x, y = link1 * cos1 + x2, link1 * sin1 + y2
        # Overwritten step by step: beam and residual, then the pull of each distance on its ends.
        rows = (self.to_rows @ parameters).reshape(3, -1, draws)
        beam_x, beam_y, residual = rows
        beam_x += x[self.state]
        beam_y += y[self.state]
        length = beam_x * beam_x
        length += beam_y * beam_y
        np.sqrt(length, out=length)
        residual += length
        residual -= displacement_mm
        residual *= self.squares
        np.divide(residual, length, out=length)
        beam_x *= length
        beam_y *= length
        force_x, force_y = self.gather @ beam_x, self.gather @ beam_y
        on_states = np.stack(
            [
                cos1 * force_x + sin1 * force_y,
                cos12 * force_x + sin12 * force_y,
                x * force_y - y * force_x,
                x2 * force_y - y2 * force_x,
            ]
        )
        gradient = self.from_states @ on_states.reshape(-1, draws)
        gradient += self.from_rows @ rows.reshape(-1, draws)
        return np.asarray(gradient, dtype=np.float64)


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
    """Identify the predicted distances with errors added, every draw to the minimum of its own sum of squares.

    Draws that do not settle, or that a step throws further than their errors reach, are solved by damped Gauss-Newton
    steps.

    Args:
        problem: what the draws have in common.
        noise_mm: errors of the distances, one row a draw, shape (draws, n).

    Raises:
        ConvergenceError: a draw has no minimum near the nominal arm.
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
        gradient = problem.gradient(parameters[:, open_], measured[:, open_])
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
    """What steps and gradients tell about the inverse Hessians of draws; without any it is 1.

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
    points = replace(problem.model.points, displacement_mm=problem.predicted_mm + noise_mm)
    model = replace(problem.model, points=points)
    basis = model.layout.gauge_basis()
    return minimise(model.residuals, model.jacobian, problem.nominal, basis, problem.weights).parameters


def _distinct_states(model: DistanceModel) -> tuple[Ints, Ints]:
    """Return a row of each distinct arm state, and the state of each distance."""
    commands, terms = model.design.commands, model.layout.terms
    acting = [i for i, term in enumerate(terms) if term.target != "length"]
    columns = [commands.theta1_rad, commands.theta2_rad, commands.direction1, commands.direction2]
    table = np.column_stack([*columns, model.design.extra[:, acting]])
    _, first, state = np.unique(table, axis=0, return_index=True, return_inverse=True)
    return first, np.ravel(state)


def _arm_matrix(model: DistanceModel, rows: Ints) -> sparse.csr_array:
    """Return how L1, L2, θ1 and θ2 of the states follow from all parameters."""
    blocks = []
    for quantity in range(4):
        local = np.zeros((len(model.points), 4))
        local[:, quantity] = 1.0
        blocks.append(model.design.spread(local)[rows])
    arm = np.vstack(blocks)
    return sparse.csr_array(np.hstack([arm, np.zeros((arm.shape[0], model.layout.size - arm.shape[1]))]))


def _row_matrix(model: DistanceModel) -> sparse.csr_array:
    """Return what the parameters add to each distance's beam, in x and y, and to its length."""
    layout, points = model.layout, model.points
    rows = np.arange(len(points))
    x, y, added = np.zeros((3, len(points), layout.size))
    place = layout.reflectors.start + 2 * points.reflector
    x[rows, place] = -1.0
    y[rows, place + 1] = -1.0
    added[rows, layout.dead_path.start + points.dead_path] = -1.0
    for i, term in enumerate(layout.terms):
        if term.target == "length":
            added[:, layout.extension.start + i] = model.design.extra[:, i]
    return sparse.csr_array(np.vstack([x, y, added]))
