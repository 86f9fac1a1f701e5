"""What a measurement drives to: a node, the way there in legs, and the time it takes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.clear_way import require_clear_legs
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint
from catseye.procedures.scara.motion.tracking import Track, aimed_along

Leg = tuple[Pose, ...]
"""Joint targets of a straight way in J1 and J2; J4 follows the reflector."""


@dataclass(frozen=True)
class Visit:
    """The way to one point and its measurement.

    Attributes:
        command: the node that is measured.
        legs: the way in straight legs, each a sequence of joint targets; the very last one is the node itself.
        tracked: the beam is kept over all these moves; otherwise the count is zeroed at the node.
        duration_s: expected time of motion, settling and dwell.
        miss_mm: largest miss on the way, NaN where the beam is not kept.
        beam_mm: length of the beam at the node.
    """

    command: Command
    legs: tuple[Leg, ...]
    tracked: bool
    duration_s: float
    miss_mm: float
    beam_mm: float

    @property
    def moves(self) -> tuple[Pose, ...]:
        """All joint targets in order."""
        return tuple(target for leg in self.legs for target in leg)

    @property
    def node(self) -> Pose:
        """Joints at the node."""
        return self.legs[-1][-1]


def require_clear_visits(visits: Sequence[Visit], bench: ScaraBench) -> None:
    """Refuse points, measured one after the other, on whose way bodies come too near to each other.

    Raises:
        PlanError: names the bodies, their distance and the target.
    """
    legs = [leg for visit in visits for leg in visit.legs]
    if legs:
        require_clear_legs(legs[0][0], legs, bench)


def leg_targets(
    stops: tuple[Waypoint, ...], track: Track, i: int, parts: int, bench: ScaraBench, reflector: Reflector
) -> Leg:
    """Return the joint targets of the leg that ends at stop i, driven in equal parts."""
    end = np.array([stops[i].theta1_deg, stops[i].theta2_deg])
    start = np.array([stops[i - 1].theta1_deg, stops[i - 1].theta2_deg]) if parts > 1 else end
    theta = end - np.arange(parts - 1, -1, -1)[:, None] / parts * (end - start)
    j4 = np.rad2deg(aimed_along(np.deg2rad(theta), float(track.j4_rad[i]), bench, reflector))
    return tuple(
        (float(one), float(two), bench.j3_mm, float(four)) for (one, two), four in zip(theta, j4, strict=True)
    )


def driving_time_s(start: Pose, legs: tuple[Leg, ...], bench: ScaraBench) -> float:
    """Return the expected time of a way in legs, each of which ends at a standstill, s."""
    motion_s = 0.0
    for leg in legs:
        motion_s += way_time_s(bench.arm, np.array([start, *leg]))
        start = leg[-1]
    return motion_s


def measuring_time_s(bench: ScaraBench) -> float:
    """Return the expected time of settling and dwell, s."""
    return bench.timing.settle_time_s + bench.timing.dwell_time_s


def plan_visits(
    stops: tuple[Waypoint, ...], track: Track, bench: ScaraBench, reflector: Reflector
) -> tuple[tuple[Visit, ...], tuple[Command, ...]]:
    """Return the points that see the reflector, with the way to each, and the commands that do not."""
    visits: list[Visit] = []
    blind: list[Command] = []
    first = 0
    for i, stop in enumerate(stops):
        if stop.command is None:
            continue
        if not track.stop_seen[i]:
            blind.append(stop.command)
            continue
        tracked = bool(visits) and bool(track.leg_seen[first : i + 1].all())
        legs = tuple(
            leg_targets(stops, track, k, int(track.sub_steps[k]) if tracked else 1, bench, reflector)
            for k in range(first, i + 1)
        )
        start = visits[-1].moves[-1] if visits else legs[0][0]
        miss = float(np.max(track.miss_mm[first : i + 1])) if tracked else float("nan")
        duration = driving_time_s(start, legs, bench) + measuring_time_s(bench)
        visits.append(Visit(stop.command, legs, tracked, duration, miss, float(track.beam_mm[i])))
        first = i + 1
    return tuple(visits), tuple(blind)


def break_warnings(reflector: Reflector, breaks: int) -> list[str]:
    """Return what an operator should know of the places where a plan gives the beam up; nothing without any."""
    if not breaks:
        return []
    return [
        f"reflector {reflector.name}: the beam cannot be kept {breaks} time(s); each begins a new segment with a "
        "dead path of its own"
    ]
