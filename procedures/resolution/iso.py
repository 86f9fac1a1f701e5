"""The test of ISO 230: three sequences of ten equal steps, there, back and there, with growing steps."""

from collections.abc import Iterable
from functools import partial
from typing import Annotated

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
from catseye.procedures.resolution.equal_steps import equal_steps
from catseye.procedures.resolution.explained import RESOLUTION_ISO
from catseye.procedures.resolution.planning import JointParams, joint_campaign
from catseye.procedures.resolution.questions import CAMPAIGN
from catseye.procedures.resolution.records import Configuration, Move
from catseye.procedures.resolution.resolution import run_in
from catseye.procedures.resolution.step_sizes import ISO_STEPS, there_and_back
from catseye.procedures.resolution.way import DOSSIER, EQUAL, EVALUATE, REPORT

Amplitude = Annotated[float, Field(ge=1e-5, le=0.5)]


class IsoParams(JointParams):
    """What may be chosen for the test of ISO 230."""

    amplitudes_deg: list[Amplitude] = Field(
        [0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05],
        min_length=1,
        max_length=50,
        title="Steps, deg",
        description="size of the steps of each test, in increasing order, deg",
    )
    relative: bool = Field(
        False,
        title="Relative steps",
        description="add each step to the measured position; false: drive to absolute positions, as is usual",
    )


class ResolutionIso(Procedure):
    """Steps one joint there, back and there again, test after test with larger steps."""

    name = "resolution-iso"
    title = "Motion resolution of joints after ISO 230"
    explanation = RESOLUTION_ISO
    needs = Needs(roles=("interferometer", "environment"), optics=("angular",))
    stage = EQUAL
    analyses = (EVALUATE, REPORT, DOSSIER)
    sets_up_anew = True
    live_plots = "steps"
    records = (Configuration, Move, Recorded)
    event_texts = LOSS_TEXTS
    questions = CAMPAIGN
    params_type = IsoParams

    def plan(self, bench: Bench, params: IsoParams) -> CampaignPlan:
        """Plan every place and series; see `joint_campaign`."""
        return joint_campaign(bench, params, partial(_series, bench, params))

    async def run(self, ctx: Context, plan: CampaignPlan) -> None:
        """Set up, record, go on; see `carry_out`."""
        await carry_out(ctx, plan)


def _series(bench: Bench, params: IsoParams, axis: str, name: str, pose: Pose) -> Iterable[Series]:
    resolution = (bench.arm.command_resolution or {}).get("deg", 0.0)
    for size in sorted(set(params.amplitudes_deg)):
        if size < resolution:
            continue
        moves = there_and_back(size, (1, -1, 1), ISO_STEPS)
        orders = (
            tuple(Order(number, by) for number, by in moves)
            if params.relative
            else equal_steps(bench, axis, pose, moves)
        )
        yield Series(
            f"{axis}/{name}/iso/{size:g}",
            f"{axis} at {name}, steps of {size:g}°",
            "iso",
            1,
            run_in(bench, axis, pose, params.run_in_deg),
            orders,
            amplitude=size,
        )
