"""Repeatability: poses attained again and again, after ISO 9283, seen along the beams to one or more reflectors."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import integer
from catseye.procedures.scara import texts
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.before import ALIGNED, COUNTER, REFLECTORS, WARM
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import REPEATABILITY
from catseye.procedures.scara.following.rounds import Rounds
from catseye.procedures.scara.motion.point_row import links_of
from catseye.procedures.scara.questions import ROUNDS
from catseye.procedures.scara.records import Repeat
from catseye.procedures.scara.repeats.repeatability_plan import (
    ReflectorCycles,
    RepeatabilityPlan,
    plan_repeatability,
)
from catseye.procedures.scara.repeats.repeatability_result import Series, analyse, show, take

Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
PoseParam = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class RepeatabilityParams(BaseModel):
    """What may be chosen for a repeatability test."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    poses: (
        Annotated[int, Field(ge=1, le=50)] | Annotated[list[PoseParam], Field(min_length=1, max_length=50)]
    ) = Field(
        5,
        title="Poses",
        description="number of poses to spread over the nodes, or the poses themselves as [[J1, J2], …] in deg",
    )
    cycles: int = Field(
        30, ge=2, le=1000, title="Cycles", description="how often the arm approaches each pose"
    )
    reflectors: list[str] = Field(
        [], title="Reflectors", description="names of the reflectors to measure to; empty: all"
    )


class Repeatability(Procedure):
    """Attains poses from fixed run-ins with the beam kept, cycle after cycle, on each reflector in turn."""

    name = "repeatability"
    title = "Pose repeatability"
    explanation = REPEATABILITY
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(ALIGNED, WARM), basis=SEARCHED)
    records = (Repeat,)
    event_texts = texts.REPEATABILITY
    questions = ROUNDS
    params_type = RepeatabilityParams

    def plan(self, bench: ScaraBench, params: RepeatabilityParams) -> RepeatabilityPlan:
        """Plan the test; see plan_repeatability."""
        given = params.poses
        poses = given if isinstance(given, int) else tuple((pose[0], pose[1]) for pose in given)
        return plan_repeatability(bench, poses, params.cycles, tuple(params.reflectors))

    async def run(self, ctx: Context, plan: RepeatabilityPlan) -> None:
        """Attain all poses in all cycles.

        Raises:
            BeamLostError: the beam was lost again and again and the operator stops.
            InsufficientPointsError: no pose was attained twice with one dead path.
        """
        done_s, nests = 0.0, Nests(ctx, plan.bench)
        series: list[Series] = []
        for part, cycle_s in zip(plan.reflectors, plan.cycle_s, strict=True):
            rounds = Rounds(ctx, plan.bench, part.trip, nests)
            own = [Series(part, pose) for pose in range(len(plan.poses))]
            for cycle in range(plan.cycles):
                title = f"{part.reflector.name}: cycle {cycle + 1} of {plan.cycles}"
                step_id = f"{part.reflector.name}/cycle/{cycle:04d}"
                row = await ctx.step(step_id, title, partial(_cycle, ctx, plan, part, rounds, cycle))
                rounds.segment = max(rounds.segment, integer(row["segment"]))
                take(own, row, cycle)
                show(ctx, own)
                done_s += cycle_s
                ctx.progress(done_s, plan.duration_s, title)
            series += own
        await ctx.step("analyse", "repeatability of the poses", partial(analyse, ctx, plan, series))


async def _cycle(
    ctx: Context, plan: RepeatabilityPlan, part: ReflectorCycles, rounds: Rounds, cycle: int
) -> Row:
    """Attain all poses once; a cycle in which the beam is lost is driven again in a new segment."""
    while True:
        await rounds.begin()
        attained = await _attained(part, rounds, cycle)
        if rounds.ready:
            break
    rounds.succeed()
    for pose, measured in enumerate(attained):
        if measured is not None:
            ctx.record(_record(plan, part, rounds.segment, cycle, pose, measured))
    return {
        "segment": rounds.segment,
        "displacement_mm": [None if measured is None else measured.displacement_mm for measured in attained],
    }


async def _attained(part: ReflectorCycles, rounds: Rounds, cycle: int) -> Sequence[Measurement | None]:
    """Drive a cycle; what is returned holds only if the beam lasted."""
    attained: list[Measurement | None] = []
    for number, leg in enumerate(part.trip.legs):
        await rounds.drive(leg)
        if number % 2:
            continue
        pose = number // 2
        # A point that the operator leaves out is None too, but the beam is still counted.
        where = f"{part.reflector.name} pose {pose + 1} cycle {cycle + 1}"
        attained.append(await rounds.measure(where))
        if not rounds.ready:
            break
    return attained


def _record(
    plan: RepeatabilityPlan, part: ReflectorCycles, segment: int, cycle: int, pose: int, measured: Measurement
) -> Repeat:
    return Repeat(
        reflector=part.reflector.name,
        segment=segment,
        cycle=cycle + 1,
        pose=pose + 1,
        theta1_deg=plan.poses[pose][0],
        theta2_deg=plan.poses[pose][1],
        direction1=1,
        direction2=1,
        displacement_mm=measured.displacement_mm,
        spread_mm=measured.spread_mm,
        signal=measured.beam.signal,
        temperature_c=measured.air.temperature_c,
        time_utc=measured.time_utc,
        extra=links_of(measured),
    )
