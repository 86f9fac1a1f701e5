"""Poses of a repeatability test and the closed way over them, the same for all reflectors."""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import beam_direction
from catseye.calibration.standards.repeatability import GOOD_CONDITIONING, conditioning
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.round_trip import LinkPose, RoundTrip, beam_lasts, plan_round_trip
from catseye.procedures.scara.motion.visits import measuring_time_s

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ReflectorCycles:
    """The cycles with the beam on one reflector.

    Attributes:
        reflector: what is aimed at.
        trip: one cycle: run-in and pose, run-in and pose, and back.
        direction_rad: world direction of the beam at each pose, rad.
    """

    reflector: Reflector
    trip: RoundTrip
    direction_rad: tuple[float, ...]


@dataclass(frozen=True)
class RepeatabilityPlan:
    """A whole repeatability test.

    Attributes:
        bench: what it was made from.
        poses: J1 and J2 of the poses, deg, in order; each is approached upwards in both joints.
        cycles: how often each is attained with the beam on each reflector.
        reflectors: in measuring order.
        cycle_s: expected time of a cycle for each reflector, s.
    """

    bench: ScaraBench
    poses: tuple[LinkPose, ...]
    cycles: int
    reflectors: tuple[ReflectorCycles, ...]
    cycle_s: tuple[float, ...]

    @property
    def duration_s(self) -> float:
        """Expected time of everything, s."""
        return self.cycles * sum(self.cycle_s)


def plan_repeatability(
    bench: ScaraBench, poses: int | tuple[LinkPose, ...], cycles: int, names: tuple[str, ...]
) -> RepeatabilityPlan:
    """Plan a repeatability test.

    Args:
        poses: J1 and J2 of the poses, deg; or how many to spread over the nodes.
        names: reflectors; all when empty.

    Raises:
        PlanLimitError: a pose or its run-in lies outside the limits.
        PlanError: the beam cannot be kept over the poses, a reflector is unknown or stands in the way.
    """
    reflectors = bench.chosen(names)
    if len(set(names)) != len(names):
        raise PlanError("a reflector is named twice; its distances would pass for another direction")
    chosen = _spread(bench, poses, reflectors) if isinstance(poses, int) else _ordered(poses)
    plans = tuple(_cycles(bench, chosen, reflector) for reflector in reflectors)
    seconds = tuple(plan.trip.driving_s + len(chosen) * measuring_time_s(bench) for plan in plans)
    return RepeatabilityPlan(bench, chosen, cycles, plans, seconds)


def _ordered(poses: tuple[LinkPose, ...]) -> tuple[LinkPose, ...]:
    if len(set(poses)) != len(poses):
        raise PlanError("a pose is given twice; every pose is attained once in each cycle")
    return poses


def _stops(poses: tuple[LinkPose, ...], bench: ScaraBench) -> tuple[LinkPose, ...]:
    """Return run-in and pose in turns: both joints come up to every pose, whatever came before."""
    back = bench.take_up_deg
    return tuple(stop for one, two in poses for stop in ((one - back, two - back), (one, two)))


def _cycles(bench: ScaraBench, poses: tuple[LinkPose, ...], reflector: Reflector) -> ReflectorCycles:
    trip = plan_round_trip(_stops(poses, bench), bench, reflector)
    if trip is None:
        listed = ", ".join(f"({one:g}°, {two:g}°)" for one, two in poses)
        raise PlanError(
            f"the beam to reflector {reflector.name} cannot be kept on the way over the poses {listed}: distances of "
            "different cycles would have no dead path in common. Choose poses nearer to one another, other "
            "reflectors, or a number of poses that the program spreads itself"
        )
    return ReflectorCycles(reflector, trip, tuple(_direction(pose, bench, reflector) for pose in poses))


def _direction(pose: LinkPose, bench: ScaraBench, reflector: Reflector) -> float:
    return float(beam_direction(_position(pose, bench), reflector.xy_mm))


def _position(pose: LinkPose, bench: ScaraBench) -> Floats:
    one, two = (np.array(math.radians(angle)) for angle in pose)
    return forward(one, two, bench.link1_mm, bench.link2_mm)


def _spread(bench: ScaraBench, count: int, reflectors: tuple[Reflector, ...]) -> tuple[LinkPose, ...]:
    """Return poses among the nodes, far from one another, over which all beams last.

    Each next one is the farthest from those chosen that can be added, first among those whose beams stand
    apart; the way goes through them in order of J1.
    """
    middle = float(np.mean(bench.nodes1_deg)), float(np.mean(bench.nodes2_deg))
    nodes = [(one, two) for one in bench.nodes1_deg for two in bench.nodes2_deg]
    places = {node: _position(node, bench) for node in nodes}
    left = [node for node in nodes if _lasts((node,), bench, reflectors)]
    apart = {node: _apart(node, bench, reflectors) for node in left}
    left.sort(key=lambda node: (not apart[node], math.dist(node, middle)))
    chosen: list[LinkPose] = []
    while left and len(chosen) < count:
        if chosen:
            left.sort(key=partial(_later, places=places, chosen=chosen, apart=apart))
        candidate = left.pop(0)
        if _lasts(tuple(sorted([*chosen, candidate])), bench, reflectors):
            chosen.append(candidate)
    if len(chosen) < count:
        names = ", ".join(reflector.name for reflector in reflectors)
        raise PlanError(
            f"only {len(chosen)} of {count} poses can be found among the nodes between which the beams to {names} "
            "last: ask for fewer poses or fewer reflectors, or give the poses"
        )
    return tuple(sorted(chosen))


def _later(
    node: LinkPose, places: dict[LinkPose, Floats], chosen: list[LinkPose], apart: dict[LinkPose, bool]
) -> tuple[bool, float]:
    return not apart[node], -min(math.dist(places[node], places[own]) for own in chosen)


def _apart(pose: LinkPose, bench: ScaraBench, reflectors: tuple[Reflector, ...]) -> bool:
    """Return whether the beams at a pose stand so far apart that they tell the spread of a position."""
    if len(reflectors) < 2:
        return True
    directions = np.array([_direction(pose, bench, reflector) for reflector in reflectors])
    return conditioning(directions) >= GOOD_CONDITIONING


def _lasts(poses: tuple[LinkPose, ...], bench: ScaraBench, reflectors: tuple[Reflector, ...]) -> bool:
    stops = _stops(poses, bench)
    ranges = (bench.j1_limits_deg, bench.j2_limits_deg)
    inside = all(low <= stop[n] <= high for stop in stops for n, (low, high) in enumerate(ranges))
    return inside and all(beam_lasts(stops, bench, reflector) for reflector in reflectors)
