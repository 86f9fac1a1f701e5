"""The arm that both models describe: positions and their derivatives by the arm's parameters."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.error_map import interpolate
from catseye.calibration.scara.extension import Target, term_values
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.planar import forward, position_jacobian
from catseye.calibration.scara.points import Commands

LOCAL: dict[Target, int] = {"link1": 0, "link2": 1, "theta1": 2, "theta2": 3}
"""Where the derivative by a quantity stands among those by L1, L2, θ1, θ2."""


@dataclass(frozen=True)
class ArmDesign:
    """Commands prepared for repeated evaluation: places between nodes are found once.

    Attributes:
        layout: order of the parameters.
        commands: where the arm is sent, n rows.
        columns: columns of the two map nodes of J1 and of J2 in each row, shape (n, 4).
        weights: their weights, shape (n, 4); the sums over each joint's pair are 1.
        extra: values of the layout's further terms, shape (n, terms).
    """

    layout: Layout
    commands: Commands
    columns: Ints
    weights: Floats
    extra: Floats

    def added(self, target: Target, parameters: Floats) -> Floats:
        """Return what the further terms add to a quantity, shape (n,) or, where none does, zero."""
        own = [i for i, term in enumerate(self.layout.terms) if term.target == target]
        if not own:
            return np.zeros(1)
        return np.asarray(self.extra[:, own] @ parameters[self.layout.extension][own], dtype=np.float64)

    def links(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the lengths of both links, mm, shape (n,) or (1,)."""
        return parameters[0] + self.added("link1", parameters), parameters[1] + self.added(
            "link2", parameters
        )

    def angles(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the actual joint angles θ1, θ2 at the parameters, rad, shape (n,) each."""
        deviation = self.weights * parameters[self.columns]
        theta1 = self.commands.theta1_rad + deviation[:, 0] + deviation[:, 1]
        theta2 = self.commands.theta2_rad + deviation[:, 2] + deviation[:, 3]
        return theta1 + self.added("theta1", parameters), theta2 + self.added("theta2", parameters)

    def positions(self, parameters: Floats) -> Floats:
        """Return the positions of the J4 axis, mm, shape (n, 2)."""
        return forward(*self.angles(parameters), *self.links(parameters))

    def local_jacobian(self, parameters: Floats) -> Floats:
        """Return d(x, y) / d(L1, L2, θ1, θ2), shape (n, 2, 4)."""
        return position_jacobian(*self.angles(parameters), *self.links(parameters))

    def spread(self, local: Floats) -> Floats:
        """Spread derivatives by L1, L2, θ1, θ2 over the arm's parameters.

        Args:
            local: derivatives of one scalar per row, shape (n, 4).

        Returns:
            Derivatives by the arm's parameters, shape (n, layout.arm_size).
        """
        rows = np.arange(local.shape[0])
        wide = np.zeros((local.shape[0], self.layout.arm_size))
        wide[:, :2] = local[:, :2]
        for k in range(4):
            # Added, not set: a map of a single node has its two places in the same column.
            wide[rows, self.columns[:, k]] += self.weights[:, k] * local[:, 2 + k // 2]
        for i, term in enumerate(self.layout.terms):
            if term.target in LOCAL:
                wide[:, self.layout.extension.start + i] = self.extra[:, i] * local[:, LOCAL[term.target]]
        return wide


def arm_design(
    layout: Layout,
    commands: Commands,
    theta4_rad: Floats | None = None,
    elapsed: Floats | None = None,
    mount_rad: Floats | None = None,
) -> ArmDesign:
    """Prepare commands for a model.

    Args:
        commands: n rows.
        theta4_rad: angle of the beam against link 2, rad, shape (n,); None for positions, which it does not act on.
        elapsed: share of the measurement that has passed, -1/2 ... 1/2, shape (n,); None for its middle.
        mount_rad: by how much the interferometer is turned on J4's flange, shape (n,); None for 0.

    Raises:
        MapRangeError: a command lies outside the nodes of a map.
    """
    extra = term_values(
        layout.terms,
        {
            "theta1": commands.theta1_rad,
            "theta2": commands.theta2_rad,
            "theta4": theta4_rad,
            "elapsed": elapsed,
        },
        len(commands),
        mount_rad,
    )
    if layout.model == "conventional":
        columns = np.full((len(commands), 4), 2, dtype=np.int64)
        return ArmDesign(layout, commands, columns, np.tile([0.0, 0.0, 1.0, 0.0], (len(commands), 1)), extra)
    first = _places(layout.nodes1_rad, commands.theta1_rad, commands.direction1, layout.map1.start, "θ1")
    second = _places(layout.nodes2_rad, commands.theta2_rad, commands.direction2, layout.map2.start, "θ2")
    return ArmDesign(
        layout, commands, np.hstack([first[0], second[0]]), np.hstack([first[1], second[1]]), extra
    )


def _places(
    nodes_rad: Floats, theta_rad: Floats, direction: Ints, start: int, name: str
) -> tuple[Ints, Floats]:
    place = interpolate(nodes_rad, theta_rad, name=name)
    table = start + np.where(direction > 0, 0, nodes_rad.size)
    upper = np.minimum(place.lower + 1, nodes_rad.size - 1)
    columns = np.stack([table + place.lower, table + upper], axis=1)
    return columns, np.stack([1.0 - place.alpha, place.alpha], axis=1)
