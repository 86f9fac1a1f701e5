"""Where an identified arm really goes, with uncertainty."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import forward, require_links
from catseye.calibration.scara.points import Commands

_MARGIN_RAD = 1e-9
"""A command on the outermost node may lie beyond it by rounding."""


@dataclass(frozen=True)
class Prediction:
    """Predicted positions for commands; rows outside the identified range are NaN.

    Attributes:
        command_mm: where the nominal arm would stand, shape (n, 2).
        position_mm: where the identified arm stands, shape (n, 2).
        covariance_mm2: of x and y, mm², shape (n, 2, 2).
        inside: rows within the identified range, shape (n,).
    """

    command_mm: Floats
    position_mm: Floats
    covariance_mm2: Floats
    inside: Bools

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


def predict(arm: IdentifiedArm, commands: Commands, link1_mm: float, link2_mm: float) -> Prediction:
    """Predict the positions of commands.

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
    if inside.any():
        design = arm_design(arm.layout, commands.select(inside))
        position[inside] = design.positions(arm.parameters)
        local = design.local_jacobian(arm.parameters)
        gradient = np.stack([design.spread(local[:, axis, :]) for axis in range(2)], axis=1)
        covariance[inside] = (gradient @ arm.covariance) @ gradient.transpose(0, 2, 1)
    command = forward(commands.theta1_rad, commands.theta2_rad, link1_mm, link2_mm)
    return Prediction(command, position, covariance, inside)


def position_effects(arm: IdentifiedArm, commands: Commands) -> Floats:
    """Return what independent unit errors behind the arm's parameters do to the positions.

    Errors of neighbouring rows belong together; e eᵀ over any rows and axes is their covariance.

    Args:
        commands: n rows inside the identified range.

    Returns:
        Effects e on x and y, mm, shape (n, 2, k).

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    values, vectors = np.linalg.eigh(arm.covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    design = arm_design(arm.layout, commands)
    local = design.local_jacobian(arm.parameters)
    return np.stack([design.spread(local[:, axis, :]) @ root for axis in range(2)], axis=1)
