"""Exercise and reference pose of a warm-up, chosen so that the beam lasts from visit to visit."""

import math
from dataclasses import dataclass

from catseye.procedures.kit.errors import PlanError
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.round_trip import LinkPose, RoundTrip, beam_lasts, plan_round_trip
from catseye.procedures.scara.motion.visits import measuring_time_s

_SHARES = (1.0, 0.8, 0.6, 0.4, 0.25, 0.15)
"""Shares of the asked amplitude that are tried, largest first."""

_PLACES = (0.0, -0.3, 0.3, -0.6, 0.6)
"""Where a reference pose is tried, in half ranges from the middle of the nodes."""

_FEWEST_IN_WINDOW = 6

_NAMED = 0.9
"""An exercise smaller than this share of what was asked for is reported."""


@dataclass(frozen=True)
class WarmupPlan:
    """A whole warm-up.

    Attributes:
        bench: what it was made from.
        trip: one round of the exercise; it begins and ends at the reference pose.
        rounds: rounds between two visits.
        visit_s: expected time of an exercise and a visit.
        window_s: time over which the drift is taken.
        limit_um_per_10min: largest accepted drift.
        checks: so many visits in a row have to be below it.
        duration_limit_s: after this the arm is not warm.
        warnings: what the operator should know before it starts.
    """

    bench: ScaraBench
    trip: RoundTrip
    rounds: int
    visit_s: float
    window_s: float
    limit_um_per_10min: float
    checks: int
    duration_limit_s: float
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class Exercise:
    """What is asked for.

    Attributes:
        reflector: name; the one that permits the largest exercise when empty.
        reference_deg: J1 and J2 of the reference pose; chosen when None.
        amplitude_share: travel to either side, as a share of the half range of the nodes.
        cycle_s: time of exercise between two visits.
    """

    reflector: str
    reference_deg: LinkPose | None
    amplitude_share: float
    cycle_s: float


def plan_warmup(
    bench: ScaraBench,
    exercise: Exercise,
    window_s: float,
    limit_um_per_10min: float,
    checks: int,
    duration_limit_s: float,
) -> WarmupPlan:
    """Plan a warm-up.

    Args:
        window_s: time over which the drift is taken, s.
        limit_um_per_10min: largest accepted drift.
        checks: so many visits in a row have to be below it.
        duration_limit_s: after this the arm is not warm, s.

    Raises:
        PlanError: the beam cannot be kept on any exercise, or the times do not fit into one another.
        PlanLimitError: the reference pose lies outside the limits.
    """
    trip, share = _chosen_trip(bench, exercise)
    measuring_s = measuring_time_s(bench)
    rounds = max(1, round((exercise.cycle_s - measuring_s) / trip.driving_s))
    visit_s = rounds * trip.driving_s + measuring_s
    if window_s + checks * visit_s > duration_limit_s:
        raise PlanError(
            f"a drift over {window_s / 60:g} min and {checks} checks, one every {visit_s / 60:.1f} min, do not fit "
            f"into the time limit of {duration_limit_s / 60:g} min: raise duration_limit_min or lower window_min"
        )
    if window_s < _FEWEST_IN_WINDOW * visit_s:
        raise PlanError(
            f"window_min = {window_s / 60:g} holds fewer than {_FEWEST_IN_WINDOW} visits, one every "
            f"{visit_s / 60:.1f} min: make the window longer, or cycle_min or amplitude_share smaller"
        )
    warnings = () if share >= _NAMED else (_smaller(trip, exercise, share),)
    return WarmupPlan(
        bench, trip, rounds, visit_s, window_s, limit_um_per_10min, checks, duration_limit_s, warnings
    )


def _chosen_trip(bench: ScaraBench, exercise: Exercise) -> tuple[RoundTrip, float]:
    """Return the largest exercise on which the beam lasts, and its share of the amplitude that was asked for."""
    reflectors = bench.chosen((exercise.reflector,) if exercise.reflector else ())
    for share in _SHARES:
        for reference in _references(bench, exercise):
            for reflector in reflectors:
                stops = _stops(bench, reference, share * exercise.amplitude_share)
                if _inside(stops, bench) and beam_lasts(stops, bench, reflector):
                    trip = plan_round_trip(stops, bench, reflector)
                    if trip is not None:
                        return trip, share
    names = ", ".join(reflector.name for reflector in reflectors)
    where = "any reference pose" if exercise.reference_deg is None else "this reference pose"
    raise PlanError(
        f"the beam cannot be kept on reflector {names} during an exercise about {where}, not even a small one: "
        "choose another reference pose or reflector, or a smaller amplitude_share"
    )


def _references(bench: ScaraBench, exercise: Exercise) -> list[LinkPose]:
    if exercise.reference_deg is not None:
        return [exercise.reference_deg]
    (middle1, half1), (middle2, half2) = _middle(bench.nodes1_deg), _middle(bench.nodes2_deg)
    places = sorted(((a, b) for a in _PLACES for b in _PLACES), key=lambda place: math.hypot(*place))
    return [(middle1 + a * half1, middle2 + b * half2) for a, b in places]


def _stops(bench: ScaraBench, reference: LinkPose, share: float) -> list[LinkPose]:
    """Return reference pose, the corners of the exercise, and the run-in that ends it from the same side always."""
    one, two = reference
    half1, half2 = share * _middle(bench.nodes1_deg)[1], share * _middle(bench.nodes2_deg)[1]
    corners = [(one + a * half1, two + b * half2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return [reference, *corners, (one - bench.take_up_deg, two - bench.take_up_deg)]


def _middle(nodes_deg: tuple[float, ...]) -> tuple[float, float]:
    return 0.5 * (nodes_deg[0] + nodes_deg[-1]), 0.5 * (nodes_deg[-1] - nodes_deg[0])


def _inside(stops: list[LinkPose], bench: ScaraBench) -> bool:
    ranges = (bench.j1_limits_deg, bench.j2_limits_deg)
    return all(low <= stop[n] <= high for stop in stops for n, (low, high) in enumerate(ranges))


def _smaller(trip: RoundTrip, exercise: Exercise, share: float) -> str:
    low, high = trip.j4_range_deg
    return (
        f"the exercise has {share:.0%} of the amplitude asked for (amplitude_share = {exercise.amplitude_share:g}): "
        f"with a larger one the beam to reflector {trip.reflector.name} would be lost or a limit exceeded. "
        f"J1 goes {_range(trip, 0)}, J2 {_range(trip, 1)}, J4 {low:.0f}…{high:.0f}°"
    )


def _range(trip: RoundTrip, joint: int) -> str:
    angles = [stop[joint] for stop in trip.stops]
    return f"{min(angles):.0f}…{max(angles):.0f}°"
