"""The model turned round: commands that make an identified arm stand where it shall."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_shape
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import Hand, inverse, wrap_rad
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import inside_range, predict

_SETTLED_RAD = 1e-13
"""A step this small moves the end of the arm by less than 1e-10 mm."""

_MOST_STEPS = 40


@dataclass(frozen=True)
class Compensation:
    """Corrected commands; rows without a solution are NaN.

    Attributes:
        commands: corrected joint angles with the states of approach that they are made for, n rows.
        wished_mm: where the arm shall stand, shape (n, 2).
        u_mm: standard uncertainties of x and y there, from those of the arm's parameters, shape (n, 2).
        reachable: rows that the identified links reach, shape (n,).
        inside: rows whose corrected command lies within the identified nodes, shape (n,).
    """

    commands: Commands
    wished_mm: Floats
    u_mm: Floats
    reachable: Bools
    inside: Bools
    steps: int

    @property
    def solved(self) -> Bools:
        """Rows that have a corrected command, shape (n,)."""
        return self.reachable & self.inside


def compensate(arm: IdentifiedArm, commands: Commands, wished_mm: Floats) -> Compensation:
    """Return the commands at which the arm stands at wished positions.

    The inverse kinematics give the actual angles a = θ + Δθ(θ, s) in closed form. What
    is left, θ = a − Δθ(θ, s), is iterated from the uncorrected command. Each step shrinks the error by the largest
    slope of the maps, so kinks at their nodes do no harm, nor does a stretched arm: from 0.3 mm to 1e-9 mm it takes
    4 steps where the maps change by at most 1 mdeg a degree and 12 where they change by 100, and one that confirms.

    Args:
        commands: uncorrected commands, n rows: states of approach, elbow (θ2 >= 0 is right) and turns of J1 stay as
            they are here.
        wished_mm: where the arm shall stand, in the frame that the gauge of the arm fixes, mm, shape (n, 2).

    Raises:
        ConvergenceError: a map changes nearly as fast as the angle itself; no arm does that.
        ArgumentError: there is not one position to each command.
    """
    require_shape(wished_mm, (len(commands), 2), "wished_mm")
    reachable = _reachable(arm, commands, wished_mm)
    angles = np.full((len(commands), 2), np.nan)
    angles[reachable], steps = _iterated(arm, commands.select(reachable), wished_mm[reachable])
    corrected = Commands(angles[:, 0], angles[:, 1], commands.direction1, commands.direction2)
    # A comparison with NaN is false: rows out of reach are not inside.
    inside = inside_range(arm, corrected) & reachable
    angles[~inside] = np.nan
    u_mm = np.full(angles.shape, np.nan)
    link1, link2 = arm.parameters[:2]
    u_mm[inside] = predict(arm, corrected.select(inside), float(link1), float(link2)).u_mm
    return Compensation(corrected, wished_mm, u_mm, reachable, inside, steps)


def _reachable(arm: IdentifiedArm, commands: Commands, wished_mm: Floats) -> Bools:
    link1, link2 = arm_design(arm.layout, _held(arm, commands)).links(arm.parameters)
    radius = np.hypot(wished_mm[:, 0], wished_mm[:, 1])
    return (radius >= np.abs(link1 - link2)) & (radius <= link1 + link2)


def _iterated(arm: IdentifiedArm, commands: Commands, wished_mm: Floats) -> tuple[Floats, int]:
    """Return corrected angles, shape (n, 2), and the number of steps."""
    right = commands.theta2_rad >= 0.0
    angles = np.column_stack([commands.theta1_rad, commands.theta2_rad])
    for step in range(1, _MOST_STEPS + 1):
        present = Commands(angles[:, 0], angles[:, 1], commands.direction1, commands.direction2)
        design = arm_design(arm.layout, _held(arm, present))
        deviation = np.column_stack(design.angles(arm.parameters)) - np.column_stack(
            [design.commands.theta1_rad, design.commands.theta2_rad]
        )
        change = _elbow(wished_mm, design.links(arm.parameters), right) - angles - deviation
        change[:, 0] = wrap_rad(change[:, 0])
        angles = angles + change
        if np.all(np.abs(change) <= _SETTLED_RAD):
            return angles, step
    worst = int(np.argmax(np.abs(change).max(axis=1)))
    raise ConvergenceError(
        f"the command for x = {wished_mm[worst, 0]:g} mm, y = {wished_mm[worst, 1]:g} mm still changes by "
        f"{1e3 * np.rad2deg(np.abs(change[worst]).max()):.3g} mdeg after {_MOST_STEPS} steps: there the error map "
        "changes nearly as fast as the angle; check its nodes and identify again"
    )


def _held(arm: IdentifiedArm, commands: Commands) -> Commands:
    """Return commands held at the outermost nodes: beyond them the iteration goes on, but its end is refused."""
    held = [
        np.clip(theta, nodes[0], nodes[-1]) if nodes.size else theta
        for nodes, theta in (
            (arm.layout.nodes1_rad, commands.theta1_rad),
            (arm.layout.nodes2_rad, commands.theta2_rad),
        )
    ]
    return Commands(held[0], held[1], commands.direction1, commands.direction2)


def _elbow(wished_mm: Floats, links_mm: tuple[Floats, Floats], right: Bools) -> Floats:
    """Return the actual joint angles at wished positions, each with its own elbow, rad, shape (n, 2)."""
    link1, link2 = (np.broadcast_to(link, right.shape) for link in links_mm)
    angles = np.empty(wished_mm.shape)
    sides: tuple[tuple[Hand, Bools], ...] = (("right", right), ("left", ~right))
    for hand, rows in sides:
        angles[rows] = np.column_stack(inverse(wished_mm[rows], link1[rows], link2[rows], hand))
    return angles
