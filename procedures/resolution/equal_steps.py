"""Equal steps of one axis that are commanded as poses."""

from collections.abc import Sequence
from itertools import accumulate

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench
from catseye.procedures.resolution.campaign_plan import Order
from catseye.procedures.resolution.places import axis_number, turned


def equal_steps(
    bench: Bench, axis: str, start: Pose, moves: Sequence[tuple[int, float]]
) -> tuple[Order, ...]:
    """Return moves as poses, from where a test begins.

    Args:
        start: pose there.
        moves: number of the sequence and signed size of each, deg.
    """
    value = start[axis_number(bench, axis)]
    ends = accumulate(by for _, by in moves)
    return tuple(
        Order(number, by, turned(bench, start, axis, value + end))
        for (number, by), end in zip(moves, ends, strict=True)
    )
