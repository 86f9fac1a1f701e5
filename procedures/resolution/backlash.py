"""Backlash of joints: ten steps there and ten back, five times, with the motor torque."""

from collections.abc import Iterable
from functools import partial

from pydantic import Field

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import LOSS_TEXTS
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.resolution.campaign import carry_out
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Series
from catseye.procedures.resolution.equal_steps import equal_steps
from catseye.procedures.resolution.explained import BACKLASH
from catseye.procedures.resolution.planning import JointParams, joint_campaign
from catseye.procedures.resolution.questions import CAMPAIGN
from catseye.procedures.resolution.records import Configuration, Move
from catseye.procedures.resolution.resolution import run_in
from catseye.procedures.resolution.step_sizes import CYCLE_STEPS, CYCLES, PRELIMINARY, there_and_back
from catseye.procedures.resolution.way import DOSSIER, EVALUATE, REPORT, THERE_AND_BACK


class BacklashParams(JointParams):
    """What may be chosen for the backlash test."""

    step_deg: float = Field(0.1, ge=0.001, le=0.5, title="Step, deg", description="size of the steps, deg")


class Backlash(Procedure):
    """Steps one joint there and back around a place, as poses, and reads the torque of its motor at each."""

    name = "backlash"
    title = "Backlash of joints"
    explanation = BACKLASH
    needs = Needs(roles=("interferometer", "environment"), optics=("angular",))
    stage = THERE_AND_BACK
    analyses = (EVALUATE, REPORT, DOSSIER)
    sets_up_anew = True
    live_plots = "steps"
    records = (Configuration, Move, Recorded)
    event_texts = LOSS_TEXTS
    questions = CAMPAIGN
    params_type = BacklashParams

    def plan(self, bench: Bench, params: BacklashParams) -> CampaignPlan:
        """Plan every place and series; see `joint_campaign`."""
        return joint_campaign(bench, params, partial(_series, bench, params))

    async def run(self, ctx: Context, plan: CampaignPlan) -> None:
        """Set up, record, go on; see `carry_out`."""
        await carry_out(ctx, plan)


def _series(bench: Bench, params: BacklashParams, axis: str, name: str, pose: Pose) -> Iterable[Series]:
    preliminary = tuple((0, -params.step_deg) for _ in range(PRELIMINARY))
    cycles = tuple(
        (cycle, by)
        for cycle in range(1, CYCLES + 1)
        for _, by in there_and_back(params.step_deg, (1, -1), CYCLE_STEPS)
    )
    yield Series(
        f"{axis}/{name}/backlash",
        f"{axis} at {name}, there and back",
        "backlash",
        1,
        run_in(bench, axis, pose, params.run_in_deg),
        equal_steps(bench, axis, pose, (*preliminary, *cycles)),
        amplitude=params.step_deg,
    )
