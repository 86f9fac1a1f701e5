"""Reflector search: places of the reflectors and the beam's zero direction (Remark 1, Eq. 2)."""

import math
from collections.abc import Mapping
from typing import ClassVar, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.scara.reflector_search import SearchResult
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import ReflectorNotFoundError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.scara.before import ALIGNED
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.records import SeenReflector
from catseye.procedures.scara.search.search_plan import Jogging, SearchPlan, SearchPose, plan_search
from catseye.procedures.scara.search.search_solution import FEWEST_SIGHTINGS, Assessment, assess, weakest
from catseye.procedures.scara.search.sighting import Announcement, Lookout

_POSE_S: Final = 15.0
"""Expected time of a look; the run's own pace corrects it."""


class SearchParams(BaseModel):
    """What may be chosen for a search."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    mode: Literal["automatic", "manual"] = Field(
        "automatic",
        description="automatic scans J4; manual asks the technician to jog it and shows the signal",
    )
    poses: int = Field(8, ge=4, le=40, description="poses for each reflector")
    most_poses: int | None = Field(
        None,
        ge=4,
        le=120,
        description="poses for each reflector with those added until the aim holds; three times poses when left out",
    )
    half_range_deg: float = Field(6.0, gt=0.0, le=45.0, description="first scan to either side, deg")
    rough_place_mm: float = Field(20.0, gt=0.0, le=200.0, description="how far off a rough place may be, mm")
    largest_jog_deg: float = Field(
        2.0, gt=0.0, le=10.0, description="manual: largest turn of one answer, deg"
    )
    auto_centre: bool = Field(True, description="manual: the program centres the beam once it is back")


class ReflectorSearch:
    """Turns J4 at poses spread over the workspace until the beam comes back, then solves Eq. 2 for all."""

    name = "reflector-search"
    title = "Reflector search"
    needs: ClassVar[Needs] = Needs(ScaraBench, after=(ALIGNED,))
    records: ClassVar[tuple[type[Record], ...]] = (SeenReflector,)
    params_type = SearchParams

    def plan(self, bench: ScaraBench, params: SearchParams) -> SearchPlan:
        """Plan the search; see plan_search."""
        manual = params.mode == "manual"
        return plan_search(
            bench,
            params.poses,
            params.half_range_deg,
            params.rough_place_mm,
            params.most_poses,
            Jogging(params.largest_jog_deg, params.auto_centre) if manual else None,
        )

    async def run(self, ctx: Context, plan: SearchPlan) -> None:
        """Search for all reflectors; poses are added until the aim holds over the whole plan.

        Args:
            ctx: the bench.
            plan: what plan_search returned.

        Raises:
            ReflectorNotFoundError: too few sightings, or an aim that would not hold over the plan.
        """
        lookout = Lookout(ctx, plan)
        for number, pose in enumerate(plan.poses):
            await lookout.look(pose)
            ctx.progress((number + 1) * _POSE_S, len(plan.poses) * _POSE_S, f"search {pose.reflector.name}")
        told = await _look_further(ctx, plan, lookout)
        await ctx.step("solve", "Eq. 2 for all reflectors", lambda: _solve(ctx, plan, lookout, told))

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands."""


async def _look_further(ctx: Context, plan: SearchPlan, lookout: Lookout) -> set[SearchPose]:
    """Look from further poses until the aim holds or there is none left; stored sightings lead the same way again.

    Returns:
        Poses whose sightings were told to be left out.
    """
    spare = list(plan.further)
    told: set[SearchPose] = set()
    now = assess(plan, lookout.sightings)
    while (pose := weakest(plan, now, spare, lookout.looked)) is not None:
        spare.remove(pose)
        done = len(plan.poses) + len(plan.further) - len(spare)
        index = plan.reflectors.index(pose.reflector)
        aim_mm = now.aim_mm[index] if now.aim_mm else None
        warnings = tuple(gone.text for gone in now.left_out if gone.pose not in told)
        said = Announcement(warnings, pose.reflector.name, aim_mm, now.room_mm, done - 1)
        await lookout.look(pose, said)
        ctx.progress(done * _POSE_S, (done + 1) * _POSE_S, f"search {pose.reflector.name}, pose added")
        told |= {gone.pose for gone in now.left_out}
        now = assess(plan, lookout.sightings)
    return told


async def _solve(ctx: Context, plan: SearchPlan, lookout: Lookout, told: set[SearchPose]) -> Row:
    now = assess(plan, lookout.sightings)
    for gone in now.left_out:
        if gone.pose not in told:
            await ctx.warn(gone.text)
    _require_sightings(plan, now, lookout.looked)
    if now.found is None:
        raise ReflectorNotFoundError(now.trouble)
    await _require_aim(ctx, plan, now, lookout.looked)
    return _result(plan, now.found, now)


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
                f"the aim at reflector {reflector.name} is known to {now.aim_mm[index]:.2f} mm only (k = 1) after "
                f"{now.count(reflector)} sightings; with the plan's miss of {optics.max_miss_mm:g} mm the beam would "
                f"leave the acceptance of {optics.acceptance_mm:g} mm: search from more poses (param poses or "
                f"most_poses) or lower max_miss_mm{_seldom(now.count(reflector), looked[reflector.name])}"
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
