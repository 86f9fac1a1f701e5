"""Trips back to a pose that was measured before: what its distance has changed by is drift.

A trip begins and ends at the node that was measured last, with that node's directions of approach, so the points
themselves are driven and measured as if there were no trips.
"""

from dataclasses import dataclass, replace

import numpy as np

from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import legs_refusal
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint, require_joint_limits, with_take_up
from catseye.procedures.scara.motion.tracking import plan_track
from catseye.procedures.scara.motion.visits import Leg, Visit, driving_time_s, leg_targets, measuring_time_s

_TRIES = 3
"""Neighbouring points that a trip may begin at instead."""


@dataclass(frozen=True)
class Closure:
    """A trip to a reference pose and back with the beam kept.

    Attributes:
        number: from 1, within its reflector.
        after: place among the visits of the point after which the trip begins.
        reference: place among the visits of the pose that is measured again.
        out: legs to the reference pose; it is approached from the sides that its point was approached from.
        back: legs to the point where the trip began, approached as before; empty after the very last point.
        duration_s: expected time of motion, settling and dwell.
        miss_mm: largest miss on the way.
    """

    number: int
    after: int
    reference: int
    out: tuple[Leg, ...]
    back: tuple[Leg, ...]
    duration_s: float
    miss_mm: float


def plan_closures(
    visits: tuple[Visit, ...], count: int, bench: ScaraBench, reflector: Reflector
) -> tuple[tuple[Closure, ...], tuple[str, ...]]:
    """Plan trips that are spread evenly over the points of a reflector.

    Args:
        visits: points in measuring order.

    Returns:
        The trips that the beam can be kept on, and a warning when there are fewer than wanted.
    """
    found: list[Closure] = []
    for place in _places(len(visits), count):
        closure = _closure(visits, place, len(visits) // (2 * count), bench, reflector)
        if closure is not None and all(closure.after != other.after for other in found):
            found.append(replace(closure, number=len(found) + 1))
    if len(found) == count:
        return tuple(found), ()
    text = (
        f"reflector {reflector.name}: {count - len(found)} of {count} closure visits are left out, since the beam "
        "cannot be kept on the way to a reference pose and back; drift is watched less often"
    )
    return tuple(found), (text,)


def trip_within_reach(
    visits: tuple[Visit, ...], planned: Closure, places: list[int], bench: ScaraBench, reflector: Reflector
) -> Closure | None:
    """Plan a trip in place of one whose reference was measured before a gap in the count.

    Args:
        visits: points in measuring order.
        places: among the visits; points that the present count goes back to.

    Returns:
        The trip to the earliest of those points; None when the beam cannot be kept on the way to the first few.
    """
    for place in sorted(place for place in places if place < planned.after)[:_TRIES]:
        trip = _trip(visits, planned.after, place, bench, reflector)
        if trip is not None:
            return replace(trip, number=planned.number)
    return None


def _places(visits: int, count: int) -> list[int]:
    return [round(number * visits / count) - 1 for number in range(1, count + 1)]


def _closure(
    visits: tuple[Visit, ...], place: int, wanted: int, bench: ScaraBench, reflector: Reflector
) -> Closure | None:
    """Return a trip that begins at or before a place: the first one over enough points, or that over the most."""
    best: Closure | None = None
    for after in _beginnings(visits, place):
        first = _segment_start(visits, after)
        for reference in sorted({first, first + 1, first + 2}):
            if reference >= after:
                break
            closure = _trip(visits, after, reference, bench, reflector)
            if closure is None:
                continue
            if after - reference >= wanted:
                return closure
            if best is None or after - reference > best.after - best.reference:
                best = closure
            break
    return best


def _beginnings(visits: tuple[Visit, ...], place: int) -> list[int]:
    """Return points where a trip may begin: near the place, and near the end of the stretch before."""
    before = _segment_start(visits, place) - 1
    return [after for last in (place, before) for after in range(last, last - _TRIES, -1) if after > 0]


def _segment_start(visits: tuple[Visit, ...], place: int) -> int:
    """Return the first point of the unbroken stretch that a point belongs to."""
    while place > 0 and visits[place].tracked:
        place -= 1
    return place


def _trip(
    visits: tuple[Visit, ...], after: int, reference: int, bench: ScaraBench, reflector: Reflector
) -> Closure | None:
    here, there = visits[after], visits[reference]
    last = after == len(visits) - 1
    commands = (here.command, there.command) if last else (here.command, there.command, here.command)
    stops = _from_first_node(with_take_up(commands, bench.take_up_deg))
    try:
        require_joint_limits(stops, bench)
        track = plan_track(stops, bench, reflector, subdivide=True)
    except PlanError:
        return None
    if not track.leg_seen[1:].all():
        return None
    turn_deg = here.node[3] - float(np.rad2deg(track.j4_rad[0]))
    legs = tuple(
        _turned(leg_targets(stops, track, i, int(track.sub_steps[i]), bench, reflector), turn_deg)
        for i in range(1, len(stops))
    )
    low, high = bench.j4_limits_deg
    if not all(low <= target[3] <= high for leg in legs for target in leg):
        return None
    if legs_refusal(here.node, legs, bench) is not None:
        return None
    split = _place_of(stops, there.command, 1)
    duration_s = driving_time_s(here.node, legs, bench) + measuring_time_s(bench)
    miss_mm = float(np.max(track.miss_mm[1:]))
    return Closure(0, after, reference, legs[:split], legs[split:], duration_s, miss_mm)


def _from_first_node(stops: tuple[Waypoint, ...]) -> tuple[Waypoint, ...]:
    """Return the stops without the first take-up: the arm stands at the first node already."""
    return stops[next(i for i, stop in enumerate(stops) if stop.command is not None) :]


def _place_of(stops: tuple[Waypoint, ...], command: Command, start: int) -> int:
    return next(i for i in range(start, len(stops)) if stops[i].command == command)


def _turned(leg: Leg, turn_deg: float) -> Leg:
    """Return a leg with J4 on the branch that it is on when the trip begins."""
    return tuple((one, two, three, four + turn_deg) for one, two, three, four in leg)
