"""Reflector search: places of the reflectors and the beam's zero direction (Remark 1, Eq. 2)."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.scara import texts
from catseye.procedures.scara.before import ALIGNED, COUNTER, REFLECTORS, SEARCHING, TURNED
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import REFLECTOR_SEARCH
from catseye.procedures.scara.questions import JOG, PLACE
from catseye.procedures.scara.records import SeenReflector
from catseye.procedures.scara.search.search_plan import Jogging, SearchPlan, plan_search
from catseye.procedures.scara.search.sighting import POSE_S, SightingRun


class SearchParams(BaseModel):
    """What may be chosen for a search."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    mode: Literal["automatic", "manual"] = Field(
        "automatic",
        title="Search by",
        description="automatic: the program scans with J4; manual: it asks you to turn J4 and shows the signal",
    )
    poses: int = Field(8, ge=4, le=40, title="Poses", description="number of poses for each reflector")
    most_poses: int | None = Field(
        None,
        ge=4,
        le=120,
        title="Poses at most",
        description="poses for each reflector, including those added until the aim is good enough; left out: three "
        "times poses",
    )
    half_range_deg: float = Field(
        6.0,
        gt=0.0,
        le=45.0,
        title="First scan ±, deg",
        description="range of the first scan, to either side of the expected direction, deg",
    )
    rough_place_mm: float = Field(
        20.0,
        gt=0.0,
        le=200.0,
        title="Place known to ±, mm",
        description="how far a rough position may be from the true one, mm",
    )
    largest_jog_deg: float = Field(
        2.0,
        gt=0.0,
        le=10.0,
        title="Largest turn, deg",
        description="in mode manual: largest turn that one answer may command, deg",
    )
    auto_centre: bool = Field(
        True,
        title="Centre by program",
        description="in mode manual: the program centres the beam once it has returned",
    )


class ReflectorSearch(Procedure):
    """Turns J4 at poses spread over the workspace until the beam comes back, then solves Eq. 2 for all."""

    name = "reflector-search"
    title = "Reflector search"
    explanation = REFLECTOR_SEARCH
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(ALIGNED,), aftermath=TURNED)
    stage = SEARCHING
    records = (SeenReflector,)
    event_texts = texts.AIM
    demo = ()
    questions = (PLACE, JOG)
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

        Raises:
            ReflectorNotFoundError: too few sightings, or an aim that would not hold over the plan.
            CounterError: sign or scale of the counter are wrong.
        """
        from catseye.procedures.scara.search.counter_check import check_counter
        from catseye.procedures.scara.search.finding import look_further, solve

        looks, checked = SightingRun(ctx, plan), False
        for number, pose in enumerate(plan.poses):
            await looks.look(pose)
            done = pose.reflector not in [other.reflector for other in plan.poses[number + 1 :]]
            if done and not checked:
                checked = await check_counter(ctx, plan, looks)
            ctx.progress((number + 1) * POSE_S, len(plan.poses) * POSE_S, f"search {pose.reflector.name}")
        reported = await look_further(ctx, plan, looks)
        if not checked:
            checked = await check_counter(ctx, plan, looks)
        await ctx.step(
            "solve",
            "Eq. 2 for all reflectors",
            lambda: solve(ctx, plan, looks, reported, counter_shown=checked),
        )
