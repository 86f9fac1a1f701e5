"""From sightings to the places of the reflectors: further looks until the aim holds, and the solution of Eq. 2."""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from catseye.calibration.scara.reflector_search import SearchResult
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import ReflectorNotFoundError
from catseye.procedures.kit.expanded import EXPANDED
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.scara.search.search_plan import SearchPlan, SearchPose
from catseye.procedures.scara.search.search_solution import FEWEST_SIGHTINGS, Assessment, assess, weakest
from catseye.procedures.scara.search.sighting import POSE_S, Announcement, SightingRun


async def look_further(ctx: Context, plan: SearchPlan, run: SightingRun) -> set[SearchPose]:
    """Look from further poses until the aim holds or there is none left; stored sightings lead the same way again.

    Returns:
        Poses whose sightings were reported as left out.
    """
    spare = list(plan.further)
    reported: set[SearchPose] = set()
    now = assess(plan, run.sightings)
    while (pose := weakest(plan, now, spare, run.looked)) is not None:
        spare.remove(pose)
        done = len(plan.poses) + len(plan.further) - len(spare)
        index = plan.reflectors.index(pose.reflector)
        aim_mm = now.aim_mm[index] if now.aim_mm else None
        warnings = tuple(gone.text for gone in now.left_out if gone.pose not in reported)
        said = Announcement(warnings, pose.reflector.name, aim_mm, now.room_mm, done - 1)
        await run.look(pose, said)
        ctx.progress(done * POSE_S, (done + 1) * POSE_S, f"search {pose.reflector.name}, pose added")
        reported |= {gone.pose for gone in now.left_out}
        now = assess(plan, run.sightings)
    return reported


_NOT_SHOWN: Final = (
    "the search could not verify the scale of the counter: no move with the beam kept changed the count enough to "
    "reveal a scale that is 5 % off. open-loop checks sign and scale within its first 20 points"
)


async def solve(
    ctx: Context, plan: SearchPlan, run: SightingRun, reported: set[SearchPose], *, counter_shown: bool
) -> Row:
    """Solve Eq. 2 for all reflectors.

    Args:
        reported: poses whose sightings are known to be left out.
        counter_shown: the counter has shown its scale.

    Raises:
        ReflectorNotFoundError: too few sightings, or an aim that would not hold over the plan.
    """
    now = assess(plan, run.sightings)
    for gone in now.left_out:
        if gone.pose not in reported:
            await ctx.warn(gone.text)
    _require_sightings(plan, now, run.looked)
    if now.found is None:
        raise ReflectorNotFoundError(now.trouble)
    await _require_aim(ctx, plan, now, run.looked)
    if not counter_shown:
        await ctx.warn(_NOT_SHOWN)
    return {**_result(plan, now.found, now), "counter_shown": counter_shown}


def _require_sightings(plan: SearchPlan, now: Assessment, looked: Mapping[str, int]) -> None:
    for reflector in plan.reflectors:
        count = now.count(reflector)
        if count < FEWEST_SIGHTINGS:
            raise ReflectorNotFoundError(
                f"reflector {reflector.name} was found from {count} pose(s), {FEWEST_SIGHTINGS} are needed: check "
                "that it stands where the cell file says, that the beam is level and free, or widen "
                f"half_range_deg (now {plan.half_range_deg:g}°){_seldom(count, looked[reflector.name])}"
            )


async def _require_aim(ctx: Context, plan: SearchPlan, now: Assessment, looked: Mapping[str, int]) -> None:
    optics = plan.bench.optics
    for index, reflector in enumerate(plan.reflectors):
        if not now.holds(index):
            raise ReflectorNotFoundError(
                f"the aim at reflector {reflector.name} is known to {EXPANDED * now.aim_mm[index]:.2f} mm only "
                f"(k = 2) after {now.count(reflector)} sightings; with the plan's miss of {optics.max_miss_mm:g} mm "
                f"the beam would leave the acceptance of {optics.acceptance_mm:g} mm: search from more poses (param "
                f"poses or most_poses) or lower max_miss_mm{_seldom(now.count(reflector), looked[reflector.name])}"
            )
    worst = max(now.aim_mm)
    await ctx.event(
        "aim",
        worst_uncertainty_mm=worst,
        acceptance_mm=optics.acceptance_mm,
        room_mm=now.room_mm,
        poses=len(now.kept),
        holds=True,
    )


def _seldom(count: int, looked: int) -> str:
    if 2 * count >= looked:
        return ""
    return f"; it was seen from {count} of {looked} poses only: level the beam first (catseye run beam-level)"


def _result(plan: SearchPlan, found: SearchResult, now: Assessment) -> Row:
    rms = math.degrees(float(np.sqrt(np.mean(found.residuals_rad**2))))
    places: list[Json] = [
        {
            "name": reflector.name,
            "x_mm": float(found.reflectors_mm[i, 0]),
            "y_mm": float(found.reflectors_mm[i, 1]),
            "u_x_mm": float(found.u_reflectors_mm[i, 0]),
            "u_y_mm": float(found.u_reflectors_mm[i, 1]),
            "u_aim_mm": now.aim_mm[i],
            "sightings": now.count(reflector),
        }
        for i, reflector in enumerate(plan.reflectors)
    ]
    return {
        "reflectors": places,
        "theta40_deg": math.degrees(found.theta40_rad),
        "u_theta40_deg": math.degrees(found.u_theta40_rad),
        "rms_deg": rms,
        "left_out": [gone.text for gone in now.left_out],
    }
