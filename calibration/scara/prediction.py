"""Where an identified arm really goes, with uncertainty."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import forward, require_links
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction_errors import PredictionErrors, position_errors

_MARGIN_RAD = 1e-9
"""A command on the outermost node may lie beyond it by rounding."""


@dataclass(frozen=True)
class Prediction:
    """Predicted positions for commands; rows outside the identified range are NaN.

    Attributes:
        command_mm: where the nominal arm would stand, shape (n, 2).
        position_mm: where the identified arm stands, shape (n, 2).
        covariance_mm2: of x and y of a single arrival, mm², shape (n, 2, 2); see
            `catseye.calibration.scara.prediction_errors`.
        inside: rows within the identified range, shape (n,).
        parts_mm2: what each contributor adds to the variance of x and y together, mm², shape (n,) each.
    """

    command_mm: Floats
    position_mm: Floats
    covariance_mm2: Floats
    inside: Bools
    parts_mm2: Mapping[str, Floats]

    @property
    def u_mm(self) -> Floats:
        """Standard uncertainties of x and y, shape (n, 2)."""
        variances = np.einsum("nii->ni", self.covariance_mm2)
        return np.asarray(np.sqrt(np.maximum(variances, 0.0)), dtype=np.float64)

    @property
    def error_mm(self) -> Floats:
        """Predicted minus command position, shape (n, 2)."""
        return self.position_mm - self.command_mm


def inside_nodes(nodes_rad: Floats, theta_rad: Floats) -> Bools:
    """Return which angles lie within the nodes of a map, shape (n,); all of them where there is no map."""
    if nodes_rad.size == 0:
        return np.ones(theta_rad.shape, dtype=np.bool_)
    low, high = nodes_rad[0] - _MARGIN_RAD, nodes_rad[-1] + _MARGIN_RAD
    return np.asarray((theta_rad >= low) & (theta_rad <= high), dtype=np.bool_)


def inside_range(arm: IdentifiedArm, commands: Commands) -> Bools:
    """Return which commands lie within the identified nodes, shape (n,); maps are never extrapolated."""
    layout = arm.layout
    return inside_nodes(layout.nodes1_rad, commands.theta1_rad) & inside_nodes(
        layout.nodes2_rad, commands.theta2_rad
    )


_BLOCK = 4096
"""Commands whose errors are worked out at a time: there are hundreds of sources."""


def predict(arm: IdentifiedArm, commands: Commands, link1_mm: float, link2_mm: float) -> Prediction:
    """Predict the positions of commands, and how far a single arrival may be from them.

    Args:
        commands: joint angles with their direction of approach, n rows.
        link1_mm: nominal length of link 1, mm, for the command position.
        link2_mm: nominal length of link 2, mm.

    Raises:
        ArgumentError: a link is not positive.
    """
    require_links(link1_mm, link2_mm)
    inside = inside_range(arm, commands)
    position = np.full((len(commands), 2), np.nan)
    covariance = np.full((len(commands), 2, 2), np.nan)
    parts: dict[str, Floats] = {}
    rows = np.flatnonzero(inside)
    for start in range(0, rows.size, _BLOCK):
        block = rows[start : start + _BLOCK]
        chosen = commands.select(block)
        position[block] = arm_design(arm.layout, chosen).positions(arm.parameters)
        errors = position_errors(arm, chosen, alone=True)
        covariance[block] = _covariances(errors)
        for name, variance in errors.variances_mm2.items():
            own = parts.setdefault(name, np.full(len(commands), np.nan))
            own[block] = variance.reshape(-1, 2).sum(axis=1)
    command = forward(commands.theta1_rad, commands.theta2_rad, link1_mm, link2_mm)
    return Prediction(command, position, covariance, inside, parts)


def _covariances(errors: PredictionErrors) -> Floats:
    """Return the covariance of x and y of each command, mm², shape (n, 2, 2)."""
    effects = errors.effects_mm.reshape(-1, 2, errors.effects_mm.shape[1])
    covariance = effects @ effects.transpose(0, 2, 1)
    covariance[:, [0, 1], [0, 1]] += errors.white_mm2.reshape(-1, 2)
    return np.asarray(covariance, dtype=np.float64)
