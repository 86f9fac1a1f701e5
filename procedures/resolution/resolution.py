"""Motion resolution of joints: exponentially decaying steps in one direction, after the resolution paper."""

from collections.abc import Iterable
from functools import partial
from typing import Literal

from pydantic import Field

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import LOSS_TEXTS
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.resolution.campaign import carry_out
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Order, Series
from catseye.procedures.resolution.explained import RESOLUTION
from catseye.procedures.resolution.places import turned
from catseye.procedures.resolution.planning import SIGNS, JointParams, joint_campaign
from catseye.procedures.resolution.questions import CAMPAIGN
from catseye.procedures.resolution.records import Configuration, Move
from catseye.procedures.resolution.step_sizes import FIRST_DEG, RATIO, STEPS, decaying
from catseye.procedures.resolution.way import DECAYING, DOSSIER, EVALUATE, MODEL, PREDICT, REPORT


class ResolutionParams(JointParams):
    """What may be chosen for the decaying test."""

    directions: list[Literal[1, -1]] = Field(
        [1, -1],
        min_length=1,
        title="Directions",
        description="directions of motion; each is a series of its own",
    )
    first_deg: float = Field(
        FIRST_DEG, ge=0.001, le=1.0, title="First step, deg", description="size of the first step, deg"
    )
    steps: int = Field(
        STEPS,
        ge=5,
        le=400,
        title="Number of steps",
        description="number of steps; fewer if the controller cannot resolve smaller ones",
    )


class Resolution(Procedure):
    """Steps one joint in one direction, each step relative to where the joint is measured to stand."""

    name = "resolution"
    title = "Motion resolution of joints"
    explanation = RESOLUTION
    needs = Needs(roles=("interferometer", "environment"), optics=("angular",))
    stage = DECAYING
    analyses = (EVALUATE, MODEL, PREDICT, REPORT, DOSSIER)
    sets_up_anew = True
    live_plots = "steps"
    records = (Configuration, Move, Recorded)
    event_texts = LOSS_TEXTS
    questions = CAMPAIGN
    params_type = ResolutionParams

    def plan(self, bench: Bench, params: ResolutionParams) -> CampaignPlan:
        """Plan every place and series; see `joint_campaign`."""
        return joint_campaign(bench, params, partial(_series, bench, params))

    async def run(self, ctx: Context, plan: CampaignPlan) -> None:
        """Set up, record, go on; see `carry_out`."""
        if ended := ended_early(plan):
            await ctx.warn(ended)
        await carry_out(ctx, plan)


def ended_early(plan: CampaignPlan) -> str:
    """Return why the series of a plan go no further down; empty where the controller is not the reason."""
    resolution = (plan.bench.arm.command_resolution or {}).get("deg", 0.0)
    last = min(abs(order.command) for place in plan.places for order in place.series[0].orders)
    if last / RATIO >= resolution:
        return ""
    return (
        f"the series end at {last:.3g}°: over this driver, no step smaller than {resolution:g}° can be added to the "
        "joint position that the controller reports"
    )


def _series(bench: Bench, params: ResolutionParams, axis: str, name: str, pose: Pose) -> Iterable[Series]:
    resolution = (bench.arm.command_resolution or {}).get("deg")
    sizes = decaying(params.first_deg, params.steps, resolution)
    for direction in params.directions:
        sign = SIGNS[direction]
        yield Series(
            f"{axis}/{name}/{sign}",
            f"{axis}{sign} at {name}",
            "decaying",
            direction,
            run_in(bench, axis, pose, direction * params.run_in_deg),
            tuple(Order(1, direction * size) for size in sizes),
        )


def run_in(bench: Bench, axis: str, pose: Pose, by_deg: float) -> tuple[Pose, ...]:
    """Return the poses that lead to a place by a motion of one axis, which takes up its play."""
    value = pose[[each.name for each in bench.arm.axes].index(axis)]
    return (turned(bench, pose, axis, value - by_deg), pose)
