"""The way into a measurement from wherever the arm stands: planned and checked when it is known where that is."""

import math

import numpy as np

from catseye.drivers.roles.pose import SAME_PLACE, Pose
from catseye.procedures.kit.errors import WayBlockedError
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.tracking import aimed_along
from catseye.procedures.scara.motion.visits import Visit


def approach(visit: Visit, bench: ScaraBench, reflector: Reflector) -> tuple[Pose, Pose]:
    """Return take-up pose and node: from the one to the other both joints move in the point's directions."""
    command, node = visit.command, visit.node
    one = command.theta1_deg - command.direction1 * bench.take_up_deg
    two = command.theta2_deg - command.direction2 * bench.take_up_deg
    theta = np.deg2rad([[one, two], node[:2]])
    j4 = math.degrees(float(aimed_along(theta, math.radians(node[3]), bench, reflector)[0]))
    low, high = bench.j4_limits_deg
    # The beam is not needed on the way in, so at a limit of J4 the take-up does without the aim.
    return (one, two, bench.j3_mm, j4 if low <= j4 <= high else node[3]), node


def way_in(here: Pose, take_up: Pose, bench: ScaraBench) -> tuple[Pose, ...]:
    """Return the targets that lead from where the arm stands to a take-up pose, that pose included.

    J3 goes to its height first, where the arm stands. Then the joints move straight if that way is free; otherwise
    J2 folds or stretches the arm first, J1 turns it, and J2 brings it to the target.

    Args:
        take_up: where the way leads.

    Raises:
        WayBlockedError: a reflector stands in every way, or the arm stands outside its limits at another height.
    """
    way = free_way(here, take_up, bench)
    if isinstance(way, str):
        raise WayBlockedError(f"{way}. Jog the arm to where its way is free, then go on")
    return way


def free_way(here: Pose, take_up: Pose, bench: ScaraBench) -> tuple[Pose, ...] | str:
    """Return the way of `way_in`, or why there is none."""
    lift = _lift(here, take_up[2])
    if lift and not _within_limits(lift, bench):
        return (
            f"the arm stands at J3 = {here[2]:.1f} mm, not at {take_up[2]:g} mm, and outside the cell's "
            f"limits (J1 {here[0]:.1f}°, J2 {here[1]:.1f}°, J4 {here[3]:.1f}°): jog it inside them first"
        )
    start = lift[-1] if lift else here
    if lift and (blocked := way_refusal((here, *lift), bench)) is not None:
        return f"J3 cannot go to its height: {blocked}"
    refusal = way_refusal((start, take_up), bench)
    if refusal is None:
        return (*lift, take_up)
    for two in sorted(
        {*bench.nodes2_deg, start[1], take_up[1]}, key=lambda two: abs(two - start[1]) + abs(two - take_up[1])
    ):
        way = _folded(start, take_up, two)
        if _within_limits(way, bench) and way_refusal((start, *way), bench) is None:
            return (*lift, *way)
    return (
        f"there is no free way from θ1 = {here[0]:.1f}°, θ2 = {here[1]:.1f}° to θ1 = {take_up[0]:.1f}°, "
        f"θ2 = {take_up[1]:.1f}°: {refusal}"
    )


def _lift(here: Pose, j3_mm: float) -> tuple[Pose, ...]:
    return () if abs(here[2] - j3_mm) <= SAME_PLACE else ((here[0], here[1], j3_mm, here[3]),)


def _folded(start: Pose, take_up: Pose, two: float) -> tuple[Pose, ...]:
    _, _, three, four = take_up
    return (start[0], two, three, four), (take_up[0], two, three, four), take_up


def _within_limits(way: tuple[Pose, ...], bench: ScaraBench) -> bool:
    # J3 has been brought to its height before.
    return all(bench.arm.axes[n].allows(target[n]) for target in way for n in (0, 1, 3))
