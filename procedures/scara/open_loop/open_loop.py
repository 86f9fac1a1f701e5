"""The automated open-loop tracking measurement."""

from dataclasses import replace

from pydantic import BaseModel, ConfigDict, Field

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import MostLeftOutError
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.scara import texts
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.before import ALIGNED, COUNTER, IDENTIFY, MEASURING, REFLECTORS, WARM
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.off_node import usual_count
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, Rules, plan_open_loop
from catseye.procedures.scara.records import ClosureVisit, Distance, Overlap

_MOST = 0.5
"""A run that leaves out more than this share of its points has not measured."""


class OpenLoopParams(BaseModel):
    """What may be chosen for a measurement."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflectors: list[str] = Field([], description="names of the reflectors to measure; all when empty")
    subdivide: bool = Field(True, description="split moves so that the beam is kept; false shows what breaks")
    take_up: bool = Field(True, description="approach each node from its side; false shows what that shifts")
    closures: int = Field(2, ge=0, le=20, description="visits to a reference pose for drift, each reflector")
    off_node: int | None = Field(
        None,
        ge=0,
        le=50,
        description="commands between the nodes, which show what the maps cannot hold; by default 12, or fewer where "
        "J1 has few nodes",
    )
    drift_limit_um: float = Field(30.0, gt=0.0, le=1000.0, description="drift that is warned of beyond, µm")
    recovery_attempts: int = Field(
        3, ge=1, le=20, description="failures in a row to get a lost beam back before the operator is asked"
    )
    stop_at_mdeg: float = Field(
        0.0,
        ge=0.0,
        le=100.0,
        description="largest standard uncertainty of both maps to stop early at, mdeg; 0 never",
    )


class OpenLoop(Procedure):
    """Visits every node from both sides, and a few places between them, with the beam on each reflector in turn."""

    name = "open-loop"
    title = "Automated open-loop tracking measurement"
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(ALIGNED, WARM), basis=SEARCHED)
    stage = MEASURING
    records = (Distance, Overlap, ClosureVisit)
    analyses = (IDENTIFY,)
    event_texts = texts.MEASUREMENT
    demo = ()
    params_type = OpenLoopParams

    def plan(self, bench: ScaraBench, params: OpenLoopParams) -> OpenLoopPlan:
        """Plan the measurement; see plan_open_loop."""
        plan = plan_open_loop(
            bench,
            subdivide=params.subdivide,
            take_up=params.take_up,
            reflectors=tuple(params.reflectors),
            closures=params.closures,
            off_node=usual_count(bench.nodes1_deg) if params.off_node is None else params.off_node,
        )
        rules = Rules(params.recovery_attempts, params.drift_limit_um * 1e-3, params.stop_at_mdeg)
        return replace(plan, rules=rules)

    async def run(self, ctx: Context, plan: OpenLoopPlan) -> None:
        """Measure all reflectors.

        Raises:
            BeamLostError: the beam stays away and the operator ends the run.
            WayBlockedError: the arm cannot be led to a point from where it stands.
            CounterError: sign or scale of the counter are wrong.
            MostLeftOutError: most points were left out.
        """
        from catseye.procedures.scara.counter import CounterWatch
        from catseye.procedures.scara.open_loop.campaign import ReflectorCampaign
        from catseye.procedures.scara.open_loop.live_knowledge import Knowledge

        time = BenchTime(ctx, plan.duration_s)
        reflectors = tuple(part.reflector for part in plan.reflectors)
        knowledge = Knowledge(ctx, plan.bench, reflectors, plan.rules.stop_at_mdeg)
        counter = CounterWatch(plan.bench)
        for text in plan.warnings:
            await ctx.warn(text)
        left_out: list[str] = []
        visited = 0
        for part in plan.reflectors:
            campaign = ReflectorCampaign(ctx, plan, part, knowledge, counter, time)
            enough = await campaign.run()
            left_out += campaign.left_out
            visited += len(part.visits)
            if enough:
                await _report_enough(ctx, plan, time)
                break
        if left_out:
            await ctx.warn(f"{len(left_out)} points were left out: {'; '.join(left_out)}")
        if len(left_out) > _MOST * visited:
            raise MostLeftOutError(
                f"{len(left_out)} of {visited} points were left out, so this is no measurement: see why in the run "
                "(catseye show), put it right and measure again"
            )


async def _report_enough(ctx: Context, plan: OpenLoopPlan, time: BenchTime) -> None:
    text = (
        f"both maps are known to {plan.rules.stop_at_mdeg:g} mdeg (stop_at_mdeg): no more points are needed"
    )
    await ctx.event("early-stop", stop_at_mdeg=plan.rules.stop_at_mdeg, text=text)
    time.cut_short(text)
