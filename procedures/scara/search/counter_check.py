"""A short way with the beam kept, on which the counter shows its sign and scale."""

from typing import Final

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.reflector_search import SearchResult, locate_reflectors
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.counter import CounterWatch
from catseye.procedures.scara.motion.round_trip import RoundTrip, plan_round_trip
from catseye.procedures.scara.search.search_plan import SearchPlan
from catseye.procedures.scara.search.search_solution import COVERAGE, sightings_table
from catseye.procedures.scara.search.sighting import Sighting, SightingRun

_TURNS_DEG: Final = tuple(turn for deg in (12.0, -12.0, 24.0, -24.0) for turn in ((deg, 0.0), (0.0, deg)))
"""By how much J1 or J2 may turn on the way."""

_LEAST_MM: Final = 20.0
"""A beam that changes by less shows no scale."""

_PLACE_MM: Final = 1.0
"""Largest standard uncertainty of a reflector whose distance is stated as the dead path of a zero."""

_FEWEST: Final = 6
"""Sightings of a reflector whose scatter says how well its place is known."""

_TRIES: Final = 3


async def check_counter(ctx: Context, plan: SearchPlan, run: SightingRun) -> bool:
    """Drive a short way from the pose that was looked from last; return whether the counter could be looked at.

    Raises:
        CounterError: its sign or its scale is wrong.
    """
    seen = run.just_seen
    trip = None if seen is None else _trip(plan, seen, run.sightings)
    if trip is None:
        return False

    async def action() -> Row:
        for _ in range(_TRIES):
            if await _counted(ctx, plan.bench, trip):
                return {"checked": True}
        return {"checked": False}

    name = trip.reflector.name
    result = await ctx.step(f"counter/{name}", f"{name}: sign and scale of the counter", action)
    return bool(result["checked"])


async def _counted(ctx: Context, bench: ScaraBench, trip: RoundTrip) -> bool:
    """Drive the way once; return whether the count was kept all along."""
    await ctx.move(trip.start)
    await ctx.zero(trip.beam_mm[0])
    target = trip.reflector
    aimed = bench.aimed({target.name: (target.x_mm, target.y_mm)}, bench.optics.theta40_deg)
    watch, timing = CounterWatch(aimed, _PLACE_MM), bench.timing
    counts = []
    for stop, leg in zip((*trip.stops, trip.stops[0]), ((), *trip.legs), strict=True):
        if leg:
            await ctx.follow(leg)
        measured = await ctx.measure(timing.settle_time_s, timing.dwell_time_s, timing.readings)
        counts.append((stop, measured))
    kept = all(measured.beam.count_valid for _, measured in counts)
    for (one, two), measured in counts if kept else ():
        watch.take(target.name, 0, one, two, measured.displacement_mm)
    return kept


def _trip(plan: SearchPlan, seen: Sighting, sightings: list[Sighting]) -> RoundTrip | None:
    """Return the way on which the beam changes most; None where the aim would not hold on any."""
    reflector, bench = seen.pose.reflector, plan.bench
    own = [one for one in sightings if one.pose.reflector == reflector]
    if len(own) < _FEWEST:
        return None
    try:
        found = locate_reflectors(
            sightings_table((reflector,), own),
            bench.link1_mm,
            bench.link2_mm,
            reflector.xy_mm[None, :],
            np.deg2rad(bench.optics.theta40_deg),
        )
    except CalibrationError:
        return None
    if found.u_reflectors_mm.max() > _PLACE_MM:
        return None
    x_mm, y_mm = found.reflectors_mm[0].tolist()
    aimed = bench.aimed({reflector.name: (x_mm, y_mm)}, float(np.rad2deg(found.theta40_rad)))
    target = next(one for one in aimed.reflectors if one.name == reflector.name)
    trips = [_planned(aimed, target, found, seen, turn) for turn in _TURNS_DEG]
    return max((trip for trip in trips if trip is not None), key=_change_mm, default=None)


def _planned(
    aimed: ScaraBench,
    target: Reflector,
    found: SearchResult,
    seen: Sighting,
    turn: tuple[float, float],
) -> RoundTrip | None:
    begin = np.array([seen.pose.theta1_deg, seen.pose.theta2_deg])
    stops = [begin + share * np.array(turn) for share in (0.0, 0.5, 1.0)]
    try:
        trip = plan_round_trip([(float(one), float(two)) for one, two in stops], aimed, target)
    except PlanError:
        return None
    one, two = np.deg2rad(stops).T
    positions = forward(one, two, aimed.link1_mm, aimed.link2_mm)
    room_mm = aimed.optics.acceptance_mm - aimed.optics.max_miss_mm
    holds = COVERAGE * found.aim_uncertainty_mm(positions, 0).max() <= room_mm
    return trip if trip is not None and holds and _change_mm(trip) >= _LEAST_MM else None


def _change_mm(trip: RoundTrip) -> float:
    return max(trip.beam_mm) - min(trip.beam_mm)
