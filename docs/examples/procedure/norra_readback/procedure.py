"""How well an axis reports that it stands where it was sent: two places, approached again and again."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from statistics import fmean, pstdev
from typing import ClassVar

from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.pose import Pose, with_axis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError, PlanLimitError, ProcedureError
from catseye.procedures.kit.event_text import EventText
from catseye.procedures.kit.explanation import Explanation
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.questions import Question
from catseye.procedures.kit.records import Record, Row
from catseye.procedures.kit.stored import numbers_of

SETTLE_S = 0.5

FREE = Question("free", "confirm", "nobody is in the arm's way", "free", motion=True)


class Params(BaseModel):
    """What may be chosen."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    axis: str = Field("J1", title="Axis", description="name of the axis that moves")
    travel_deg: float = Field(
        2.0, gt=0.0, le=10.0, title="Travel, deg", description="to either side of zero, deg"
    )
    cycles: int = Field(5, ge=1, le=1000, title="Cycles", description="how often each place is approached")
    limit_deg: float = Field(
        0.01, gt=0.0, title="Limit, deg", description="largest deviation without a warning, deg"
    )


@dataclass(frozen=True, kw_only=True)
class Reading(Record):
    """One reported angle; its fields are the columns of the table `read_back`."""

    table: ClassVar[str] = "read_back"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "reading"

    cycle: int
    commanded_deg: float
    reported_deg: float


@dataclass(frozen=True)
class Plan:
    """What will be done.

    Attributes:
        number: of the axis, from 0.
        places: poses that are approached in turn.
        params: as chosen.
    """

    number: int
    places: tuple[Pose, Pose]
    params: Params


class ReadBack(Procedure):
    """Sends one axis to and fro, and compares what the controller reports with what was commanded."""

    name = "norra-readback"
    title = "Reported against commanded angles"
    explanation = Explanation(
        "One axis moves to and fro between two places. After each motion the controller's reported angle is compared "
        "with the commanded one. Nobody needs to be present once the way is free.",
        example=("cycles=10",),
    )
    params_type = Params
    needs = Needs(bench=Bench)
    records = (Reading,)
    questions = (FREE,)
    event_texts: ClassVar = {
        "read-back": EventText(
            lambda data: (
                f"deviation {data['mean_deg']:+.4f}° ± {data['sd_deg']:.4f}°, "
                f"largest {data['largest_deg']:.4f}°"
            ),
            shown=True,
        )
    }

    def plan(self, bench: Bench, params: Params) -> Plan:
        """Plan both places; every other axis stays at zero, or as near as its range allows.

        Raises:
            PlanError: there is no such axis, or it does not turn.
            PlanLimitError: a place is out of its range.
        """
        axes = bench.arm.axes
        names = [axis.name for axis in axes]
        if params.axis not in names:
            raise PlanError(f"there is no axis {params.axis}: choose one of {', '.join(names)}")
        number = names.index(params.axis)
        axis = axes[number]
        if axis.unit != "deg":
            raise PlanError(f"{axis.name} does not turn: choose another axis")
        if not axis.low <= -params.travel_deg < params.travel_deg <= axis.high:
            raise PlanLimitError(
                f"{axis.name} would turn beyond {axis.low:g}…{axis.high:g}°: choose a smaller travel_deg"
            )
        zero = tuple(min(max(0.0, each.low), each.high) for each in axes)
        down, up = (with_axis(zero, number, side * params.travel_deg) for side in (-1.0, 1.0))
        return Plan(number, (down, up), params)

    async def run(self, ctx: Context, plan: Plan) -> None:
        """Approach both places in all cycles.

        Raises:
            ProcedureError: somebody is in the arm's way.
        """
        prompt = FREE.prompt("free", "Confirm that nobody is in the arm's way.", target=plan.places[0])
        if await ctx.ask(prompt) != "yes":
            raise ProcedureError("the way was not free: start again when nobody is in the arm's way")
        deviations: list[float] = []
        cycles = plan.params.cycles
        for cycle in range(cycles):
            title = f"cycle {cycle + 1} of {cycles}"
            row = await ctx.step(f"cycle/{cycle:04d}", title, partial(_cycle, ctx, plan, cycle))
            deviations += numbers_of(row, "deviations_deg")
            _show(ctx, plan, deviations)
        await ctx.step("result", "deviations", partial(_result, ctx, plan, deviations))


async def _cycle(ctx: Context, plan: Plan, cycle: int) -> Row:
    deviations: list[float] = []
    for place in plan.places:
        await ctx.move(place)
        await ctx.pause(SETTLE_S)
        commanded, reported = place[plan.number], (await ctx.joints())[plan.number]
        ctx.record(Reading(cycle=cycle + 1, commanded_deg=commanded, reported_deg=reported))
        deviations.append(reported - commanded)
    return {"deviations_deg": [*deviations]}


async def _result(ctx: Context, plan: Plan, deviations: Sequence[float]) -> Row:
    largest_deg = max(map(abs, deviations))
    result: Row = {"mean_deg": fmean(deviations), "sd_deg": pstdev(deviations), "largest_deg": largest_deg}
    await ctx.event("read-back", **result)
    if largest_deg > plan.params.limit_deg:
        await ctx.warn(
            f"{plan.params.axis} is reported {largest_deg:.4f}° beside its command, {plan.params.limit_deg:g}° are "
            "accepted: look at the controller's in-position width"
        )
    return result


def _show(ctx: Context, plan: Plan, deviations: Sequence[float]) -> None:
    ctx.show(Live("largest deviation", max(map(abs, deviations)), "deg", high=plan.params.limit_deg))
