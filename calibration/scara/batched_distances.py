"""Distances of many draws of one plan at once.

The gradient needs no dense Jacobian: commands that repeat share their trigonometry, and what is linear is sparse.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.distance_model import DistanceModel


@dataclass(frozen=True)
class BatchedDistances:
    """Rows of a Monte Carlo; m distinct arm states among n distances, p parameters.

    Attributes:
        model: the distances, their commands and the order of the parameters.
        command_rad: commands of the k distinct angles of both joints, shape (k, 1).
        to_angles: parameters to what is added to these, shape (k, p).
        angle: angles of θ1 and of θ2 of each state, shape (m,) each.
        to_links: parameters to L1 and L2 of the states, shape (2 m, p).
        from_states: derivatives by L1, L2, θ1 and θ2 of the states to those by the parameters, shape (p, 4 m).
        to_rows: parameters to minus reflector x, y and to what is added to the lengths, shape (3 n, p).
        from_rows: its transpose.
        state: state of each distance, shape (n,).
        gather: sums x and y of distances over their state, shape (2 m, 2 n).
    """

    model: DistanceModel
    command_rad: Floats
    to_angles: sparse.csr_array
    angle: tuple[Ints, Ints]
    to_links: sparse.csr_array
    from_states: sparse.csr_array
    to_rows: sparse.csr_array
    from_rows: sparse.csr_array
    state: Ints
    gather: sparse.csr_array

    @classmethod
    def of(cls, model: DistanceModel) -> "BatchedDistances":
        """Prepare a plan."""
        first, state = _distinct_states(model)
        to_states, to_rows = _arm_matrix(model, first), _row_matrix(model)
        commands = model.design.commands
        turns = np.concatenate([commands.theta1_rad[first], commands.theta2_rad[first]])[:, None]
        # Few angles make many states: each is worked out once.
        angles, angle = np.unique(
            np.hstack([turns, to_states[2 * first.size :]]), axis=0, return_inverse=True
        )
        gather = sparse.csr_array((np.ones(state.size), (state, np.arange(state.size))))
        theta1, theta2 = np.split(np.ravel(angle), 2)
        return cls(
            model=model,
            command_rad=angles[:, :1],
            to_angles=sparse.csr_array(angles[:, 1:]),
            angle=(theta1, theta2),
            to_links=sparse.csr_array(to_states[: 2 * first.size]),
            from_states=sparse.csr_array(to_states.T),
            to_rows=to_rows,
            from_rows=to_rows.T.tocsr(),
            state=state,
            gather=sparse.csr_array(sparse.block_diag([gather, gather])),
        )

    @property
    def measured_mm(self) -> Floats:
        """Measured displacements, mm, shape (n,)."""
        return self.model.points.displacement_mm

    def with_measured(self, measured_mm: Floats) -> DistanceModel:
        """Return the model of a draw's displacements, mm, shape (n,)."""
        return replace(self.model, points=replace(self.model.points, displacement_mm=measured_mm))

    def gradient(self, values: Floats, measured_mm: Floats, forces: Callable[[Floats], Floats]) -> Floats:
        """Return half the gradients of the sums of squares.

        Args:
            values: of the parameters, one column a draw, shape (p, b).
            measured_mm: displacements, one column a draw, shape (n, b).
            forces: returns V⁻¹ times residuals, shape (n, b).

        Returns:
            The exact JᵀV⁻¹r, shape (p, b).
        """
        draws = values.shape[1]
        link1, link2 = (self.to_links @ values).reshape(2, -1, draws)
        angles = self.to_angles @ values + self.command_rad
        cos, sin = np.cos(angles), np.sin(angles)
        (cos1, cos2), (sin1, sin2) = ([each[own] for own in self.angle] for each in (cos, sin))
        cos12, sin12 = cos1 * cos2 - sin1 * sin2, sin1 * cos2 + cos1 * sin2
        x2, y2 = link2 * cos12, link2 * sin12
        x, y = link1 * cos1 + x2, link1 * sin1 + y2
        # Overwritten step by step: beam and residual, then the pull of each distance on its ends.
        rows = (self.to_rows @ values).reshape(3, -1, draws)
        beam_x, beam_y, residual = rows
        beam_x += x[self.state]
        beam_y += y[self.state]
        length = beam_x * beam_x
        length += beam_y * beam_y
        np.sqrt(length, out=length)
        residual += length
        residual -= measured_mm
        residual[:] = forces(residual)
        np.divide(residual, length, out=length)
        beam_x *= length
        beam_y *= length
        force_x, force_y = (self.gather @ rows[:2].reshape(-1, draws)).reshape(2, -1, draws)
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


def _distinct_states(model: DistanceModel) -> tuple[Ints, Ints]:
    """Return a row of each distinct arm state, and the state of each distance."""
    commands, terms = model.design.commands, model.layout.terms
    acting = [i for i, term in enumerate(terms) if term.target != "length"]
    columns = [commands.theta1_rad, commands.theta2_rad, commands.direction1, commands.direction2]
    table = np.column_stack([*columns, model.design.extra[:, acting]])
    _, first, state = np.unique(table, axis=0, return_index=True, return_inverse=True)
    return first, np.ravel(state)


def _arm_matrix(model: DistanceModel, rows: Ints) -> Floats:
    """Return how L1, L2, θ1 and θ2 of the states follow from all parameters."""
    blocks = []
    for quantity in range(4):
        local = np.zeros((len(model.points), 4))
        local[:, quantity] = 1.0
        blocks.append(model.design.spread(local)[rows])
    arm = np.vstack(blocks)
    return np.hstack([arm, np.zeros((arm.shape[0], model.layout.size - arm.shape[1]))])


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
