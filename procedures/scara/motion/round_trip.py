"""A closed way that is driven again and again with the beam kept on one reflector, so that its count goes on."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanLimitError
from catseye.procedures.kit.motion.clear_way import require_clear_legs
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Waypoint, require_joint_limits
from catseye.procedures.scara.motion.tracking import Track, plan_track
from catseye.procedures.scara.motion.visits import Leg, driving_time_s, leg_targets

LinkPose = tuple[float, float]
"""J1 and J2, deg."""

_PIECE_DEG = 20.0
"""A longer leg is split evenly over pieces: near a reflector it needs more sub-steps than far from it."""


@dataclass(frozen=True)
class RoundTrip:
    """A closed way over stops.

    Attributes:
        reflector: what the beam is kept on.
        stops: J1 and J2, deg, in order; the way ends where it begins.
        start: joints at the first stop.
        legs: legs that lead to the second stop, the third, and so on, the last one back to the first.
        beam_mm: length of the beam at each stop.
        j4_range_deg: smallest and largest J4 on the way.
        driving_s: expected time of the motion.
    """

    reflector: Reflector
    stops: tuple[LinkPose, ...]
    start: Pose
    legs: tuple[Leg, ...]
    beam_mm: tuple[float, ...]
    j4_range_deg: tuple[float, float]
    driving_s: float


def beam_lasts(stops: Sequence[LinkPose], bench: ScaraBench, reflector: Reflector) -> bool:
    """Return whether limits permit a closed way, nothing stands in it, and the reflector is seen all along.

    Args:
        stops: J1 and J2, deg.
    """
    try:
        return _kept(plan_track(_closed(stops)[0], bench, reflector, subdivide=False))
    except PlanLimitError:
        return False


def plan_round_trip(stops: Sequence[LinkPose], bench: ScaraBench, reflector: Reflector) -> RoundTrip | None:
    """Plan a closed way.

    Args:
        stops: J1 and J2, deg, two at least.

    Returns:
        None when the beam cannot be kept all along.

    Raises:
        PlanLimitError: a stop lies outside the limits.
        PlanError: a reflector stands in the way, or is too near to be tracked.
    """
    closed, ends = _closed(stops)
    require_joint_limits(closed, bench)
    track = plan_track(closed, bench, reflector, subdivide=True)
    if not _kept(track):
        return None
    legs = tuple(
        tuple(
            target
            for i in range(first + 1, last + 1)
            for target in leg_targets(closed, track, i, int(track.sub_steps[i]), bench, reflector)
        )
        for first, last in pairwise(ends)
    )
    start = legs[-1][-1]
    require_clear_legs(start, legs, bench)
    j4 = [target[3] for leg in legs for target in leg]
    return RoundTrip(
        reflector=reflector,
        stops=tuple(stops),
        start=start,
        legs=legs,
        beam_mm=tuple(float(track.beam_mm[end]) for end in ends[:-1]),
        j4_range_deg=(min(j4), max(j4)),
        driving_s=driving_time_s(start, legs, bench),
    )


def _closed(stops: Sequence[LinkPose]) -> tuple[tuple[Waypoint, ...], list[int]]:
    """Return the closed way with long legs in pieces, and which of its places are the stops."""
    way, ends = [Waypoint(*stops[0], None)], [0]
    for start, end in pairwise((*stops, stops[0])):
        travel = end[0] - start[0], end[1] - start[1]
        pieces = max(1, math.ceil(max(map(abs, travel)) / _PIECE_DEG))
        between = [
            (start[0] + k / pieces * travel[0], start[1] + k / pieces * travel[1]) for k in range(1, pieces)
        ]
        way += [Waypoint(one, two, None) for one, two in (*between, end)]
        ends.append(len(way) - 1)
    return tuple(way), ends


def _kept(track: Track) -> bool:
    # A way around the reflector would wind J4 up with every trip.
    return bool(track.leg_seen[1:].all()) and math.isclose(track.j4_rad[0], track.j4_rad[-1], abs_tol=1e-6)
