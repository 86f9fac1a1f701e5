"""The measuring sequence and the way each node is approached from its proper side.

Direction of approach is a physical state. Where the sequence reverses or restarts, a joint overshoots by the
take-up angle and comes back, so that the last real motion has the direction that the point claims.
"""

from dataclasses import dataclass

from catseye.procedures.kit.errors import PlanLimitError
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class Command:
    """A node to measure, or a place between nodes.

    Attributes:
        index: place in the sequence, from 0.
        theta1_deg: J1 command.
        theta2_deg: J2 command.
        direction1: state of approach of J1, 1 or -1.
        direction2: state of approach of J2, 1 or -1.
    """

    index: int
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int


@dataclass(frozen=True)
class Waypoint:
    """A stop on the way: a command to measure, or a take-up position.

    Attributes:
        theta1_deg: J1 command.
        theta2_deg: J2 command.
        command: what is measured here; None at a take-up position.
    """

    theta1_deg: float
    theta2_deg: float
    command: Command | None


def bidirectional_sequence(
    nodes1_deg: tuple[float, ...], nodes2_deg: tuple[float, ...]
) -> tuple[Command, ...]:
    """Return the paper's sequence (Eqs 11 and 12): J2 up and down at each J1 node, J1 up and down.

    Args:
        nodes1_deg: J1 nodes, increasing.
        nodes2_deg: J2 nodes, increasing.
    """
    first = [(angle, 1) for angle in nodes1_deg] + [(angle, -1) for angle in reversed(nodes1_deg)]
    second = [(angle, 1) for angle in nodes2_deg] + [(angle, -1) for angle in reversed(nodes2_deg)]
    pairs = [(one, two) for one in first for two in second]
    return tuple(Command(index, one[0], two[0], one[1], two[1]) for index, (one, two) in enumerate(pairs))


def with_take_up(commands: tuple[Command, ...], take_up_deg: float) -> tuple[Waypoint, ...]:
    """Return the stops that bring every command its direction of approach.

    Args:
        commands: nodes in measuring order.
        take_up_deg: overshoot, deg; larger than any backlash.
    """
    stops: list[Waypoint] = []
    present: tuple[float, float] | None = None
    state = (0, 0)
    for command in commands:
        target = (command.theta1_deg, command.theta2_deg)
        wanted = (command.direction1, command.direction2)
        before = [
            _come_from(target[n], wanted[n], None if present is None else present[n], state[n], take_up_deg)
            for n in range(2)
        ]
        if before != list(target):
            stops.append(Waypoint(before[0], before[1], None))
        stops.append(Waypoint(target[0], target[1], command))
        present, state = target, wanted
    return tuple(stops)


def _come_from(target: float, wanted: int, present: float | None, state: int, take_up: float) -> float:
    """Return the angle from which the last motion of a joint starts; the target itself when none is needed."""
    if present is not None:
        travel = (target - present) * wanted
        if travel >= take_up or (state == wanted and travel >= 0.0):
            return target
    return target - wanted * take_up


def require_joint_limits(stops: tuple[Waypoint, ...], bench: ScaraBench) -> None:
    """Refuse stops outside the limits of J1 and J2; straight joint moves between them stay inside.

    Raises:
        PlanLimitError: names the first stop outside and the remedy.
    """
    limits = (("J1", bench.j1_limits_deg), ("J2", bench.j2_limits_deg))
    for stop in stops:
        for (joint, (low, high)), angle in zip(limits, (stop.theta1_deg, stop.theta2_deg), strict=True):
            if not low <= angle <= high:
                kind = "the take-up position before a node" if stop.command is None else "a node"
                raise PlanLimitError(
                    f"{kind} needs {joint} = {angle:g}°, outside its limits {low:g}°…{high:g}°: take the node "
                    f"out of [measurement], or make take_up_deg (now {bench.take_up_deg:g}°) smaller"
                )
