"""A short way with the beam kept, on which the counter shows its sign and scale."""

import asyncio
from collections import Counter
from typing import Final

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.reflector_search import SearchResult, locate_reflectors
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.counter import CounterWatch
from catseye.procedures.scara.motion.round_trip import RoundTrip, plan_round_trip
from catseye.procedures.scara.search.search_plan import SearchPlan
from catseye.procedures.scara.search.search_solution import COVERAGE, FEWEST_SIGHTINGS, sightings_table
from catseye.procedures.scara.search.sighting import Sighting, SightingRun

_TURNS_DEG: Final = tuple(
    turn for deg in (12.0, -12.0, 24.0, -24.0, 48.0, -48.0) for turn in ((deg, 0.0), (0.0, deg))
)
"""By how much J1 or J2 may turn on the way, the shortest first."""

_PLACE_MM: Final = 1.0
"""Largest standard uncertainty of a reflector whose distance is stated as the dead path of a zero."""

_FEWEST: Final = 3
"""Sightings beyond the unknowns whose scatter says how well a place is known."""

_TRIES: Final = 3


async def check_counter(ctx: Context, plan: SearchPlan, run: SightingRun) -> bool:
    """Drive a short way from a pose that the reflector was seen from; return whether the counter has shown its scale.

    Raises:
        CounterError: its sign or its scale is wrong.
    """
    seen = run.just_seen
    if seen is None:
        return False
    # Beside the loop: ways from many poses take longer to plan than the guard waits for a sign of life.
    trip = await asyncio.to_thread(_trip, plan, seen, list(run.sightings))
    if trip is None:
        return False

    async def action() -> Row:
        for _ in range(_TRIES):
            if shown := await _counted(ctx, plan.bench, trip):
                break
        # The ways to all other poses were planned from here.
        await ctx.move(_home(plan.bench, seen))
        return {"checked": shown}

    name = trip.reflector.name
    result = await ctx.step(f"counter/{name}", f"{name}: sign and scale of the counter", action)
    return bool(result["checked"])


async def _counted(ctx: Context, bench: ScaraBench, trip: RoundTrip) -> bool:
    """Drive the way once; return whether the count was kept all along and a wrong scale would have been called so."""
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
    return kept and watch.shows_scale


def _trip(plan: SearchPlan, seen: Sighting, sightings: list[Sighting]) -> RoundTrip | None:
    """Return the shortest way that shows a wrong scale; None where the aim would not hold on any that does."""
    bench, name = plan.bench, seen.pose.reflector.name
    counts = Counter(one.pose.reflector for one in sightings)
    known = tuple(one for one in plan.reflectors if counts[one] >= FEWEST_SIGHTINGS)
    own = [one for one in sightings if one.pose.reflector in known]
    if seen.pose.reflector not in known or len(own) < 2 * len(known) + 1 + _FEWEST:
        return None
    try:
        found = locate_reflectors(
            sightings_table(known, own),
            bench.link1_mm,
            bench.link2_mm,
            np.array([reflector.xy_mm for reflector in known]),
            np.deg2rad(bench.optics.theta40_deg),
        )
    except CalibrationError:
        return None
    index = known.index(seen.pose.reflector)
    if found.u_reflectors_mm[index].max() > _PLACE_MM:
        return None
    x_mm, y_mm = found.reflectors_mm[index].tolist()
    aimed = bench.aimed({name: (x_mm, y_mm)}, float(np.rad2deg(found.theta40_rad)))
    target = next(one for one in aimed.reflectors if one.name == name)
    # From a pose with the arm folded the beam hardly changes: where it was seen from before may be better.
    begins = [seen, *(one for one in sightings if one.pose.reflector == seen.pose.reflector and one != seen)]
    ways = ((begin, turn) for begin in begins for turn in _TURNS_DEG)
    trips = (_planned(aimed, target, found, index, begin, turn) for begin, turn in ways)
    return next((trip for trip in trips if trip is not None and _reached(trip, bench, seen)), None)


def _home(bench: ScaraBench, seen: Sighting) -> Pose:
    return seen.pose.theta1_deg, seen.pose.theta2_deg, bench.j3_mm, seen.j4_deg


def _reached(trip: RoundTrip, bench: ScaraBench, seen: Sighting) -> bool:
    """Return whether the way to and from a trip is free."""
    home = _home(bench, seen)
    return way_refusal((home, trip.start, home), bench) is None


def _planned(
    aimed: ScaraBench,
    target: Reflector,
    found: SearchResult,
    index: int,
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
    holds = COVERAGE * found.aim_uncertainty_mm(positions, index).max() <= room_mm
    return trip if trip is not None and holds and _shows_scale(aimed, trip) else None


def _shows_scale(aimed: ScaraBench, trip: RoundTrip) -> bool:
    """Return whether the counts of a way will show a scale that is wrong."""
    watch = CounterWatch(aimed, _PLACE_MM)
    for (one, two), beam_mm in zip(trip.stops, trip.beam_mm, strict=True):
        watch.take(trip.reflector.name, 0, one, two, beam_mm - trip.beam_mm[0])
    return watch.shows_scale
