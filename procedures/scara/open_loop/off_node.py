"""Commands between the nodes: what a map cannot hold shows there.

They lie on the way: between two rows of J2 the arm stops on its way to the next node of J1, with J2 between two of
its own nodes.
"""

from dataclasses import replace

import numpy as np

from catseye.calibration.scara.design.off_node import off_node_angles
from catseye.procedures.scara.motion.approach import Command, bidirectional_sequence

_MOST = 12
"""Commands that a plan has without being asked: twice as many make the roughness little better known."""

_STRIDE = 0.5 * (np.sqrt(5.0) - 1.0)
"""Share of J2's angles that neighbouring commands are apart: both joints vary on their own."""


def usual_count(nodes1_deg: tuple[float, ...]) -> int:
    """Return how many commands lie between the nodes where nobody says: no more than J1 has intervals each way."""
    return min(2 * (len(nodes1_deg) - 1), _MOST)


def measuring_sequence(
    nodes1_deg: tuple[float, ...], nodes2_deg: tuple[float, ...], off_node: int
) -> tuple[Command, ...]:
    """Return the paper's sequence with commands between the nodes.

    Args:
        nodes1_deg: J1 nodes, increasing.
        nodes2_deg: J2 nodes, increasing.
        off_node: how many commands lie between the nodes.
    """
    commands = list(bidirectional_sequence(nodes1_deg, nodes2_deg))
    for extra in _off_node(nodes1_deg, nodes2_deg, off_node):
        commands.insert(_place(commands, extra), extra)
    return tuple(replace(command, index=index) for index, command in enumerate(commands))


def _off_node(
    nodes1_deg: tuple[float, ...], nodes2_deg: tuple[float, ...], count: int
) -> tuple[Command, ...]:
    """Return commands with J1 upwards and downwards in turn, and J2 upwards and downwards in each of these."""
    first = off_node_angles(np.array(nodes1_deg), count)
    second = off_node_angles(np.array(nodes2_deg), count)
    order = np.argsort(np.arange(count) * _STRIDE % 1.0)
    return tuple(
        Command(0, float(one), float(second[place]), 1 - 2 * (number % 2), 1 - 2 * (number // 2 % 2))
        for number, (one, place) in enumerate(zip(first, order, strict=True))
    )


def _place(commands: list[Command], extra: Command) -> int:
    """Return where a command is passed on the way of J1."""
    return next(
        place
        for place, command in enumerate(commands)
        if command.direction1 == extra.direction1
        and (command.theta1_deg - extra.theta1_deg) * extra.direction1 > 0.0
    )
